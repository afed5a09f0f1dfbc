//! A language server for Structured Text and scan scripts.
//!
//! The crate speaks the protocol on standard input and output and keeps the documents that an editor has
//! open. For each it reports mistakes, declarations, completions and layout. The language belongs to the
//! compiler and the script format to the reader; both run again after each change.
#![forbid(unsafe_code)]

mod documents;
mod frames;
mod position;
mod script;
mod server;
mod text;
mod tree;
mod uri;

pub use frames::{FRAME_MOST, FrameError};
pub use server::{Ended, serve};

use lsp_server::Connection;
use standstill_st::Dialect;
use std::io::{self, BufReader};
use std::thread;

/// Runs the language server on standard input and output until the editor sends `exit` or closes its end.
/// Memory and work are bounded by the documents that it has open.
///
/// # Errors
/// [`FrameError`], if the input is no frame of the protocol; the next one cannot be found then.
pub fn stdio(dialect: &Dialect) -> Result<Ended, FrameError> {
    let (ours, theirs) = Connection::memory();
    let outgoing = theirs.receiver;
    let writer = thread::spawn(move || -> io::Result<()> {
        for message in outgoing {
            message.write(&mut io::stdout().lock())?;
        }
        Ok(())
    });
    let incoming = theirs.sender;
    // It ends with the process, because a read of standard input cannot be cancelled.
    let reader = thread::spawn(move || {
        let put = |message| incoming.send(message).is_ok();
        frames::read_all(&mut BufReader::new(io::stdin().lock()), put)
    });
    let ended = serve(&ours, dialect);
    drop(ours);
    match writer.join() {
        // An editor that is gone receives nothing; that is no fault of the server.
        Ok(Ok(()) | Err(_)) | Err(_) => {}
    }
    if ended == Ended::Closed
        && let Ok(Err(error)) = reader.join()
    {
        return Err(error);
    }
    Ok(ended)
}
