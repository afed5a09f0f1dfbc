//! `watch` takes over a terminal and restores it on every way out.

use crate::support::{SCRIPT, command, late, read, standstill, with_script, write};

#[test]
fn without_a_terminal_it_says_so_and_a_broken_script_comes_first() {
    let folder = with_script("watch_no_terminal");
    let ended = standstill(&folder, &["watch", "move.scan.json"]);
    assert_eq!((ended.status, ended.out.as_str()), (2, ""));
    ended.complains("watch needs a terminal, and standard input is none");
    write(&folder, "broken.scan.json", "{");
    let ended = standstill(&folder, &["watch", "broken.scan.json"]);
    assert_eq!((ended.status, ended.out.as_str()), (3, ""));
    ended.complains("broken.scan.json:1:2");
    assert_eq!(standstill(&folder, &["watch", "absent.scan.json"]).status, 4);
    assert_eq!(
        standstill(&folder, &["watch", "move.scan.json", "--set", "w=1"]).status,
        2
    );
}

#[cfg(unix)]
mod terminal {
    use super::*;
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    use rustix::process::{Pid, Signal, kill_process};
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    use rustix::termios::{LocalModes, Termios, Winsize, tcgetattr, tcsetwinsize};
    use std::fs::{File, OpenOptions};
    use std::io::{Read, Write};
    use std::os::unix::process::ExitStatusExt;
    use std::path::Path;
    use std::process::{Child, ExitStatus, Stdio};
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::{Arc, Mutex};
    use std::thread::{self, JoinHandle};
    use std::time::{Duration, Instant};

    /// Longer than any step here takes on a busy machine.
    const PATIENCE: Duration = Duration::from_secs(30);

    /// A terminal in which the program runs.
    struct Watched {
        ours: File,
        theirs: File,
        before: Termios,
        child: Child,
        shown: Arc<Mutex<Vec<u8>>>,
        deaf: Arc<AtomicBool>,
        reader: Option<JoinHandle<()>>,
    }

    impl Watched {
        fn new(folder: &Path, arguments: &[&str]) -> Self {
            // The program must not hold its own terminal open from the other side.
            let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
            let ours = openpt(flags).expect("a terminal");
            grantpt(&ours).expect("ours");
            unlockpt(&ours).expect("ours");
            let name = ptsname(&ours, Vec::new()).expect("it has a name");
            let path = name.to_str().expect("ASCII");
            let theirs = OpenOptions::new()
                .read(true)
                .write(true)
                .open(path)
                .expect("its other end");
            let size = Winsize {
                ws_row: 24,
                ws_col: 80,
                ws_xpixel: 0,
                ws_ypixel: 0,
            };
            tcsetwinsize(&theirs, size).expect("a terminal has a size");
            let before = tcgetattr(&theirs).expect("a terminal");
            assert!(before.local_modes.contains(LocalModes::ICANON | LocalModes::ECHO));
            let end = || Stdio::from(theirs.try_clone().expect("a handle"));
            let child = command(&[&["watch"], arguments].concat())
                .current_dir(folder)
                .env("NO_COLOR", "1")
                .env("TERM", "xterm")
                .stdin(end())
                .stdout(end())
                .stderr(end())
                .spawn()
                .expect("the program starts");
            let ours = File::from(ours);
            let shown = Arc::new(Mutex::new(Vec::new()));
            let (mut source, target) = (ours.try_clone().expect("a handle"), Arc::clone(&shown));
            let deaf = Arc::new(AtomicBool::new(false));
            let stop = Arc::clone(&deaf);
            let reader = thread::spawn(move || {
                let mut buffer = [0; 4096];
                while !stop.load(Ordering::Relaxed) {
                    let wait = Timespec::try_from(Duration::from_millis(20)).expect("short");
                    let ready = poll(&mut [PollFd::new(&source, PollFlags::IN)], Some(&wait));
                    if !ready.is_ok_and(|count| count > 0) {
                        continue;
                    }
                    let Ok(count @ 1..) = source.read(&mut buffer) else {
                        return;
                    };
                    target
                        .lock()
                        .expect("nobody panicked")
                        .extend_from_slice(&buffer[..count]);
                }
            });
            Self {
                ours,
                theirs,
                before,
                child,
                shown,
                deaf,
                reader: Some(reader),
            }
        }

        /// Stops reading what is written to the terminal.
        fn take_nothing(&mut self) {
            self.deaf.store(true, Ordering::Relaxed);
            if let Some(reader) = self.reader.take() {
                reader.join().expect("it did not panic");
            }
        }

        fn id(&self) -> Pid {
            let id = i32::try_from(self.child.id()).expect("a process id");
            Pid::from_raw(id).expect("not zero")
        }

        /// The status of a program that must end at once, and by itself.
        fn ends_at_once(mut child: Child) -> ExitStatus {
            // One second is promised; the rest is for a busy machine.
            let begin = Instant::now();
            loop {
                if let Some(status) = child.try_wait().expect("it is our child") {
                    return status;
                }
                if begin.elapsed() > Duration::from_secs(3) {
                    let _ = child.kill();
                    panic!("it outlives its terminal");
                }
                thread::sleep(Duration::from_millis(10));
            }
        }

        /// What was written to the terminal so far.
        fn text(&self) -> String {
            String::from_utf8_lossy(&self.shown.lock().expect("nobody panicked")).into_owned()
        }

        /// Waits until a text was written. For a new screen only the changes are written.
        fn expect(&self, text: &str) {
            let begin = Instant::now();
            while !self.text().contains(text) {
                assert!(begin.elapsed() < PATIENCE, "no `{text}` in {:?}", self.text());
                thread::sleep(Duration::from_millis(10));
            }
        }

        fn press(&mut self, keys: &str) {
            self.ours
                .write_all(keys.as_bytes())
                .expect("a terminal takes keys");
        }

        /// Waits for the end; the terminal must be in its original state.
        fn ended(mut self) -> (ExitStatus, String) {
            let begin = Instant::now();
            let status = loop {
                if let Some(status) = self.child.try_wait().expect("it is our child") {
                    break status;
                }
                if begin.elapsed() > PATIENCE {
                    let _ = self.child.kill();
                    panic!("it does not end: {:?}", self.text());
                }
                thread::sleep(Duration::from_millis(10));
            };
            let after = tcgetattr(&self.theirs).expect("a terminal");
            assert_eq!(after.local_modes, self.before.local_modes);
            assert_eq!(after.input_modes, self.before.input_modes);
            assert_eq!(after.output_modes, self.before.output_modes);
            // The other screen was left, and the cursor is there again.
            self.expect("\u{1b}[?1049l");
            self.expect("\u{1b}[?25h");
            (status, self.text())
        }
    }

    #[test]
    fn q_ends_it_and_the_terminal_is_as_before() {
        let folder = with_script("watch_q");
        let mut watched = Watched::new(&folder, &["move.scan.json"]);
        watched.expect("\u{1b}[?1049h");
        watched.expect("One short move");
        let raw = tcgetattr(&watched.theirs).expect("a terminal").local_modes;
        assert!(
            !raw.intersects(LocalModes::ICANON | LocalModes::ECHO),
            "keys come one by one"
        );
        watched.press("c");
        watched.expect("holds 21");
        watched.press("q");
        let (status, text) = watched.ended();
        assert_eq!(status.code(), Some(0), "{text:?}");
        let told = "move.scan.json: 22 of 30 scans, 1 claims hold, 0 fail, 1 open";
        assert!(text.trim_end().ends_with(told), "{text:?}");
        let colors = ["\u{1b}[31", "\u{1b}[32", "\u{1b}[38", "\u{1b}[48"];
        assert!(
            !colors.iter().any(|color| text.contains(color)),
            "no colour was wanted: {text:?}"
        );
    }

    #[test]
    fn what_was_changed_is_written_as_a_script_that_runs() {
        let folder = with_script("watch_write");
        let mut watched = Watched::new(&folder, &["move.scan.json"]);
        watched.expect("One short move");
        watched.press("\rw");
        watched.expect("written: move.watched.scan.json");
        watched.press("q");
        assert_eq!(watched.ended().0.code(), Some(0));
        let text = read(&folder, "move.watched.scan.json");
        assert!(text.contains("{\"at\": 0, \"set\": {\"GO\": true}}"), "{text}");
        // GO is TRUE a scan earlier, so Done is there, too.
        let ended = standstill(&folder, &["run", "-q", "move.watched.scan.json"]);
        ended.prints("move.watched.scan.json: ");
        assert_ne!(ended.status, 3, "{}", ended.err);
    }

    #[test]
    fn a_claim_that_failed_is_the_status() {
        let folder = with_script("watch_failed");
        write(&folder, "late.scan.json", &late());
        let mut watched = Watched::new(&folder, &["late.scan.json"]);
        watched.expect("One short move");
        watched.press("c");
        watched.expect("FAILS 19");
        watched.press("q");
        assert_eq!(watched.ended().0.code(), Some(1));
    }

    #[test]
    fn signals_end_it_and_give_the_terminal_back_first() {
        let folder = with_script("watch_signals");
        for (signal, number) in [(Signal::TERM, 15), (Signal::INT, 2), (Signal::HUP, 1)] {
            let watched = Watched::new(&folder, &["move.scan.json"]);
            watched.expect("One short move");
            kill_process(watched.id(), signal).expect("it runs");
            let (status, text) = watched.ended();
            assert_eq!(status.signal(), Some(number), "{text:?}");
        }
        // As a key, as terminals send it after they were taken over.
        let mut watched = Watched::new(&folder, &["move.scan.json"]);
        watched.expect("One short move");
        watched.press("\u{3}");
        assert_eq!(watched.ended().0.signal(), Some(2));
    }

    #[test]
    fn it_ends_with_its_terminal() {
        let folder = with_script("watch_hangup");
        // Without an end, at the speed of the clock.
        write(
            &folder,
            "long.scan.json",
            &SCRIPT.replace("\"scans\": 30", "\"scans\": 1000000"),
        );
        for keys in ["", " ", "e+++++ "] {
            let mut watched = Watched::new(&folder, &["long.scan.json"]);
            watched.expect("One short move");
            watched.press(keys);
            watched.take_nothing();
            let Watched { ours, child, .. } = watched;
            drop(ours);
            let status = Watched::ends_at_once(child);
            assert_eq!(status.signal(), Some(1), "{keys:?}: {status:?}");
        }
    }

    #[test]
    fn a_terminal_that_takes_nothing_does_not_keep_it_from_ending() {
        let folder = with_script("watch_stuck");
        write(
            &folder,
            "long.scan.json",
            &SCRIPT.replace("\"scans\": 30", "\"scans\": 1000000"),
        );
        let mut watched = Watched::new(&folder, &["long.scan.json"]);
        watched.expect("One short move");
        watched.take_nothing();
        // The screen changes until the line is full.
        watched.press("++++ ");
        thread::sleep(Duration::from_secs(1));
        kill_process(watched.id(), Signal::TERM).expect("it runs");
        let status = Watched::ends_at_once(watched.child);
        assert_eq!(status.signal(), Some(15), "{status:?}");
        // Also in the middle of a key that never ends: a terminal sends those in pieces.
        let mut watched = Watched::new(&folder, &["long.scan.json"]);
        watched.expect("One short move");
        watched.press("\u{1b}[");
        thread::sleep(Duration::from_millis(300));
        kill_process(watched.id(), Signal::TERM).expect("it runs");
        assert_eq!(watched.ended().0.signal(), Some(15));
    }

    #[test]
    fn the_end_of_the_time_gives_the_terminal_back() {
        let folder = with_script("watch_time");
        let watched = Watched::new(&folder, &["--time-limit", "500ms", "move.scan.json"]);
        watched.expect("One short move");
        let (status, text) = watched.ended();
        assert_eq!(status.code(), Some(1), "{text:?}");
        assert!(
            text.contains("the time is up; it was at move.scan.json"),
            "{text:?}"
        );
    }

    #[test]
    fn a_terminal_too_small_is_told_and_can_be_left() {
        let folder = with_script("watch_small");
        let mut watched = Watched::new(&folder, &["move.scan.json"]);
        watched.expect("One short move");
        let size = Winsize {
            ws_row: 10,
            ws_col: 40,
            ws_xpixel: 0,
            ws_ypixel: 0,
        };
        tcsetwinsize(&watched.theirs, size).expect("a terminal has a size");
        watched.press("s");
        // Words are written one by one; blanks are already there.
        watched.expect("40x10,");
        watched.press("q");
        assert_eq!(watched.ended().0.code(), Some(0));
    }
}
