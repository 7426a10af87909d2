//! Signals that end the program: what it has written and not put in place goes first.

use std::sync::atomic::{AtomicBool, Ordering};

/// Whether a signal is about to end the program.
static ENDING: AtomicBool = AtomicBool::new(false);

/// Never returns once a signal is about to end the program.
pub(crate) fn wait_if_ending() {
    while ENDING.load(Ordering::SeqCst) {
        std::thread::park();
    }
}

/// Lets SIGINT, SIGTERM and SIGHUP clean up before they end the program as they would have. Elsewhere than on Unix the next run
/// cleans up.
#[cfg(unix)]
pub(crate) fn clean_up_on_signals() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    let (installed, wait) = std::sync::mpsc::channel::<()>();
    // Without a thread to spare signals end the program at once, and the next run cleans up.
    let _ = std::thread::Builder::new().name("signals".to_owned()).spawn(move || {
        // What was ignored when the program was started, as by `nohup` or a shell's `&`, stays so. Only Linux tells that, and only
        // SIGHUP is ignored elsewhere as a rule.
        let ignored = ignored();
        let all =
            if cfg!(target_os = "linux") { &[SIGINT, SIGTERM, SIGHUP][..] } else { &[SIGINT, SIGTERM][..] };
        let heeded = all.iter().filter(|signal| ignored & (1 << (*signal - 1)) == 0);
        let Ok(mut signals) = Signals::new(heeded) else { return };
        drop(installed);
        for signal in signals.forever() {
            // Who asks twice does not wait.
            if !ENDING.swap(true, Ordering::SeqCst) {
                let _ = std::thread::Builder::new().spawn(move || {
                    poecal::io::output::clean_up();
                    let _ = emulate_default_handler(signal);
                });
            } else {
                let _ = emulate_default_handler(signal);
            }
        }
    });
    // Nothing is written before signals are heeded: the channel ends when they are, or cannot be.
    let _ = wait.recv();
}

/// The signals that this process ignores, a bit each; none where the system does not tell.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

#[cfg(not(unix))]
pub(crate) fn clean_up_on_signals() {}
