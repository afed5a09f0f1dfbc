//! `standstill serve`: the playground as a local tool, with the scripts of a folder.
//!
//! This module decides which requests are answered, and how. The page runs the scripts. Nothing is
//! written, and the server listens only on the loopback address. Other pages in the same browser can also
//! send requests there: requests under another host name are refused, and no answer can be read by other
//! pages.

#[cfg(any(unix, windows))]
mod answer;
#[cfg(any(unix, windows))]
mod folder;
#[cfg(any(unix, windows))]
mod site;

#[cfg(any(unix, windows))]
pub use desk::serve;

/// The replacement on systems without a network.
#[cfg(not(any(unix, windows)))]
pub fn serve(_: &crate::args::ServeArguments) -> Result<crate::exit::Exit, crate::exit::Failure> {
    Err(crate::exit::Failure::usage(
        "serve needs a network, and this build of standstill has none: `standstill run` shows a run as text",
    ))
}

#[cfg(any(unix, windows))]
mod desk {
    use super::answer::{Answer, plain};
    use super::folder::Folder;
    use super::site::Site;
    use crate::args::ServeArguments;
    use crate::exit::{Exit, Failure, complain};
    use crate::limit;
    use crate::test::where_scripts_are;
    use hyper::header::{HOST, IF_NONE_MATCH};
    use hyper::server::conn::http1;
    use hyper::service::service_fn;
    use hyper::{Method, Request};
    use hyper_util::rt::{TokioIo, TokioTimer};
    use percent_encoding::percent_decode_str;
    use standstill_script::suite::shown;
    use std::convert::Infallible;
    use std::future::ready;
    use std::io;
    use std::net::Ipv4Addr;
    use std::sync::Arc;
    use std::time::Duration;
    use tokio::net::TcpListener;
    use tokio::runtime;

    /// Consecutive failures to accept a connection before the server gives up. There may be too many connections
    /// for a moment.
    const FAILED_MAX: u32 = 100;

    /// The path of the folder's scripts, beside the pages.
    const SCRIPTS: &str = "/folder/";

    /// The list of scripts for the page; here it includes those of the folder.
    const LIST: &str = "/playground/scripts.json";

    /// The source of every answer.
    struct Desk {
        site: Site,
        folder: Folder,
        port: u16,
    }

    /// Answers requests until it is interrupted.
    pub fn serve(arguments: &ServeArguments) -> Result<Exit, Failure> {
        let folders: Vec<_> = arguments.folder.iter().cloned().collect();
        let mut folders = where_scripts_are(&folders);
        let folder = Folder::new(folders.remove(0), &arguments.include_from)?;
        let site = Site::find(arguments.site.as_deref())?;
        let failed = |port: u16, error: &io::Error| {
            let why = match error.kind() {
                io::ErrorKind::AddrInUse => "another program has it".to_owned(),
                _ => error.to_string(),
            };
            let remedy = "`--port N` takes another one, `--port 0` one that is free";
            Failure::Told(Exit::Io, format!("error: port {port}: {why}; {remedy}"))
        };
        let asked = arguments.port;
        // One thread answers all requests, because it only waits for the network.
        let runtime = runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|error| failed(asked, &error))?;
        let listener = runtime.block_on(TcpListener::bind((Ipv4Addr::LOCALHOST, asked)));
        let listener = listener.map_err(|error| failed(asked, &error))?;
        let port = listener
            .local_addr()
            .map_err(|error| failed(asked, &error))?
            .port();
        let desk = Desk { site, folder, port };
        let name = desk.folder.name();
        limit::doing(format!("serving {name}"));
        complain(&format!(
            "{name} in the playground: http://127.0.0.1:{port}/ (this machine only; Ctrl and C end it)"
        ));
        let error = runtime.block_on(desk.answer_all(&listener));
        Err(Failure::Told(
            Exit::Io,
            format!("error: port {port}: no more connections can be taken ({error}); start it again"),
        ))
    }

    impl Desk {
        /// Answers every connection, even while others are silent. Returns the reason for its end.
        async fn answer_all(self, listener: &TcpListener) -> io::Error {
            let desk = Arc::new(self);
            let mut failed = 0;
            loop {
                let stream = match listener.accept().await {
                    Ok((stream, _)) => stream,
                    Err(error) if failed == FAILED_MAX => return error,
                    Err(_) => {
                        failed += 1;
                        tokio::time::sleep(Duration::from_millis(50)).await;
                        continue;
                    }
                };
                failed = 0;
                let desk = Arc::clone(&desk);
                let answer = service_fn(move |request| {
                    let answer = desk.found(&request).unwrap_or_else(|refusal| refusal);
                    ready(Ok::<_, Infallible>(answer.response()))
                });
                // The client may be gone.
                tokio::spawn(
                    http1::Builder::new()
                        .timer(TokioTimer::new())
                        .serve_connection(TokioIo::new(stream), answer),
                );
            }
        }

        /// The answer, or one with the error.
        fn found<B>(&self, request: &Request<B>) -> Result<Answer, Answer> {
            // A value that is not ASCII is not ours.
            let header = |name| {
                request
                    .headers()
                    .get_all(name)
                    .iter()
                    .map(|value| value.to_str().unwrap_or_default())
            };
            if header(HOST).count() != 1 || !header(HOST).all(|host| is_ours(host, self.port)) {
                let port = self.port;
                let why = format!("this is answered under http://127.0.0.1:{port}/ and no other name");
                return Err(plain(421, &why));
            }
            if !matches!(*request.method(), Method::GET | Method::HEAD) {
                return Err(plain(
                    405,
                    "only GET and HEAD are answered: nothing is written here",
                ));
            }
            let Ok(path) = percent_decode_str(request.uri().path()).decode_utf8() else {
                return Err(plain(400, "the path is no UTF-8"));
            };
            if path == "/" {
                return Ok(Answer::elsewhere("/playground/"));
            }
            if path == LIST {
                let list = self.site.scripts()?;
                return Ok(Answer::json(&self.folder.listed(list)?));
            }
            if let Some(script) = path.strip_prefix(SCRIPTS) {
                return self.folder.script(script, header(IF_NONE_MATCH).next());
            }
            self.site.file(&path)
        }
    }

    /// Whether a page under this host name is ours. The owner of any other name may let it refer to this machine.
    fn is_ours(host: &str, port: u16) -> bool {
        let host = host.to_ascii_lowercase();
        let name = match host.strip_suffix(&format!(":{port}")) {
            Some(name) => name,
            None if port == 80 => &host,
            None => return false,
        };
        matches!(name, "127.0.0.1" | "localhost")
    }

    /// The name of a folder for people: at least the last part of its path.
    pub(super) fn name_of(folder: &std::path::Path) -> String {
        let real = folder.canonicalize().ok();
        let last = real.as_deref().and_then(|path| path.file_name());
        match last {
            Some(last) if folder.file_name().is_none() => last.to_string_lossy().into_owned(),
            _ => shown(folder),
        }
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn names_of_this_machine_are_answered_and_no_others() {
            for host in ["127.0.0.1:7480", "localhost:7480", "LocalHost:7480"] {
                assert!(is_ours(host, 7480), "{host}");
            }
            for host in [
                "",
                "127.0.0.1",
                "localhost",
                "127.0.0.1:7481",
                "evil.example:7480",
                "127.0.0.1.evil.example:7480",
                "localhost.evil.example:7480",
                "127.0.0.1:74807480",
                "0.0.0.0:7480",
                "192.168.0.7:7480",
                "127.0.0.1:7480:7480",
            ] {
                assert!(!is_ours(host, 7480), "{host}");
            }
            assert!(is_ours("localhost", 80));
        }
    }
}
