//! Runs this program again, as a process with limits.

use super::place::Place;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncReadExt as _, AsyncWriteExt as _};
use tokio::process::{Child, Command};

/// The longest answer (bytes). A longer one is refused and not cut, because half a JSON object is
/// invalid.
pub const LONGEST: usize = 256 << 10;

/// The longest message of a failure (bytes); it is cut.
const LONGEST_MESSAGE: u64 = 16 << 10;

/// The largest number of bytes that a process may write into one file.
#[cfg(target_os = "linux")]
const FILE: u64 = 256 << 20;

/// A process that ends by `--time-limit` reports its work. One that does not end is killed after this additional
/// time.
const GRACE: Duration = Duration::from_secs(2);

/// The output of a process.
#[derive(Debug)]
pub struct Said {
    /// Its exit status; none if a signal ended it.
    pub status: Option<i32>,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

/// Runs a command line of this program in a folder, with this text on standard input. It writes no
/// goldens.
///
/// # Errors
/// It could not be started, took too long, or wrote too much.
pub async fn run(place: &Place, folder: &Path, arguments: &[String], input: &[u8]) -> Result<Said, String> {
    let program = std::env::current_exe().map_err(|error| format!("this program is not found: {error}"))?;
    let mut command = Command::new(program);
    command
        .arg(format!("--time-limit={}ns", place.time.as_nanos()))
        .args(arguments)
        .current_dir(folder)
        // With this variable nothing proposes or accepts goldens.
        .env("CI", "true")
        .env("NO_COLOR", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .kill_on_drop(true);
    let mut child = command
        .spawn()
        .map_err(|error| format!("the program does not start: {error}"))?;
    hold(&child, place.memory);
    let talk = talk(&mut child, input);
    match tokio::time::timeout(place.time + GRACE, talk).await {
        Ok(said) => said,
        Err(_) => Err(format!("it was ended after {:?}", place.time)),
    }
}

/// Limits memory and files, if the system can do so for another process.
#[cfg(target_os = "linux")]
fn hold(child: &Child, memory: u64) {
    use rustix::process::{Pid, Resource, Rlimit, prlimit};
    let id = child.id().and_then(|id| i32::try_from(id).ok());
    let Some(pid) = id.and_then(Pid::from_raw) else {
        return;
    };
    for (what, most) in [
        (Resource::Data, memory),
        (Resource::Fsize, FILE),
        (Resource::Core, 0),
    ] {
        let limit = Rlimit {
            current: Some(most),
            maximum: Some(most),
        };
        // A process that has already ended needs no limits.
        let _ = prlimit(Some(pid), what, limit);
    }
}

#[cfg(not(target_os = "linux"))]
fn hold(_: &Child, _: u64) {}

async fn talk(child: &mut Child, input: &[u8]) -> Result<Said, String> {
    let failed = |error: std::io::Error| format!("the program does not answer: {error}");
    let (stdin, stdout, stderr) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
    let write = async {
        if let Some(mut stdin) = stdin {
            // If it ends before it has read everything, it reports the reason.
            let _ = stdin.write_all(input).await;
        }
    };
    let most = LONGEST as u64 + 1;
    let ((), out, err) = tokio::join!(write, up_to(stdout, most), up_to(stderr, LONGEST_MESSAGE));
    let (out, err) = (out.map_err(failed)?, err.map_err(failed)?);
    if out.len() > LONGEST {
        return Err(format!(
            "the answer has more than {LONGEST} bytes: ask for fewer scripts, signals or scans"
        ));
    }
    let status = child.wait().await.map_err(failed)?;
    Ok(Said {
        status: status.code(),
        out: String::from_utf8_lossy(&out).into_owned(),
        err: String::from_utf8_lossy(&err).into_owned(),
    })
}

/// The beginning of the output. The rest is not read; no command notices this.
async fn up_to(stream: Option<impl AsyncRead + Unpin>, most: u64) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    if let Some(stream) = stream {
        stream.take(most).read_to_end(&mut bytes).await?;
    }
    Ok(bytes)
}
