//! `standstill lsp`: the language server.

use crate::exit::{Exit, Failure};
use crate::limit;
use crate::st::dialect;
use standstill_lsp::Ended;

/// Runs the language server until the editor ends the session. An end without `shutdown` is a failure, as
/// the protocol says.
pub fn lsp(named: Option<&str>) -> Result<Exit, Failure> {
    limit::doing("serving an editor");
    match standstill_lsp::stdio(&dialect(named)?) {
        Ok(Ended::Exit) => Ok(Exit::Passed),
        Ok(Ended::ExitAtOnce | Ended::Closed) => Ok(Exit::Failed),
        Err(error) => Err(Failure::Told(Exit::Io, format!("error: {error}"))),
    }
}
