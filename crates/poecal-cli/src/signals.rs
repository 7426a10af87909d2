//! Signals that end the program, after removing its staged files.

use std::sync::atomic::{AtomicBool, Ordering};

/// True if a signal is about to end the program.
static ENDING: AtomicBool = AtomicBool::new(false);

/// Never returns once a signal is about to end the program.
pub(crate) fn wait_if_ending() {
    while ENDING.load(Ordering::SeqCst) {
        std::thread::park();
    }
}

/// Makes SIGINT, SIGTERM and SIGHUP clean up before they end the program. Elsewhere than on Unix the next run cleans up.
#[cfg(unix)]
pub(crate) fn clean_up_on_signals() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    let (installed, wait) = std::sync::mpsc::channel::<()>();
    // Without a thread, signals end the program at once, and the next run cleans up.
    let _ = std::thread::Builder::new().name("signals".to_owned()).spawn(move || {
        // Signals ignored from the start, as by `nohup` or a shell's `&`, stay ignored. Only Linux reports them; elsewhere usually only
        // SIGHUP is ignored.
        let ignored = ignored_signals();
        let all = if cfg!(target_os = "linux") { &[SIGINT, SIGTERM, SIGHUP][..] } else { &[SIGINT, SIGTERM][..] };
        let heeded = all.iter().filter(|signal| ignored & (1 << (*signal - 1)) == 0);
        let Ok(mut signals) = Signals::new(heeded) else { return };
        drop(installed);
        for signal in signals.forever() {
            // A second signal ends the program at once.
            if !ENDING.swap(true, Ordering::SeqCst) {
                let _ = std::thread::Builder::new().spawn(move || {
                    poecal_results::output::clean_up();
                    let _ = emulate_default_handler(signal);
                });
            } else {
                let _ = emulate_default_handler(signal);
            }
        }
    });
    // Waits until signals are handled: the channel closes when they are, or cannot be.
    let _ = wait.recv();
}

/// Signals ignored by this process, a bit each; 0 if the system does not report them.
#[cfg(unix)]
fn ignored_signals() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

#[cfg(not(unix))]
pub(crate) fn clean_up_on_signals() {}
