//! Standard input with a longest line.

use std::io::{self, ErrorKind};
use std::pin::Pin;
use std::task::{Context, Poll};
use tokio::io::{AsyncRead, ReadBuf};

/// The longest message of a client (bytes).
const LONGEST: usize = 16 << 20;

/// Gives an error if a line is too long, because the reader stores a line until it is complete.
#[derive(Debug)]
pub struct Bounded<R> {
    inner: R,
    /// Bytes since the last line ended.
    since: usize,
}

impl<R> Bounded<R> {
    pub const fn new(inner: R) -> Self {
        Self { inner, since: 0 }
    }
}

impl<R: AsyncRead + Unpin> AsyncRead for Bounded<R> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = buffer.filled().len();
        std::task::ready!(Pin::new(&mut self.inner).poll_read(context, buffer))?;
        let new = &buffer.filled()[before..];
        self.since = match new.iter().rposition(|byte| *byte == b'\n') {
            Some(end) => new.len() - end - 1,
            None => self.since + new.len(),
        };
        Poll::Ready(if self.since > LONGEST {
            let text = format!("a message of more than {LONGEST} bytes");
            Err(io::Error::new(ErrorKind::InvalidData, text))
        } else {
            Ok(())
        })
    }
}
