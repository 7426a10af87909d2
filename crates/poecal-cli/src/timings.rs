//! Times of the parts of a calibration.

use std::time::Duration;

use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::solve::Summary;
use serde_json::{Value, json};

/// Largest time and number of repetitions of a solve.
const LONG_ENOUGH: Duration = Duration::from_millis(300);
const MOST_REPEATS: usize = 2000;
const FEWEST_REPEATS: usize = 5;

/// CPU time of the process (all threads) and wall time.
#[derive(Clone, Copy, Default)]
struct ElapsedTime {
    cpu: Duration,
    wall: Duration,
}

impl ElapsedTime {
    fn json(self) -> Value {
        let ms = |duration: Duration| duration.as_secs_f64() * 1e3;
        json!({ "cpu_ms": ms(self.cpu), "wall_ms": ms(self.wall) })
    }

    fn minus(self, other: ElapsedTime) -> ElapsedTime {
        ElapsedTime { cpu: self.cpu.saturating_sub(other.cpu), wall: self.wall.saturating_sub(other.wall) }
    }
}

/// A stop watch for both times.
#[cfg(any(unix, windows))]
struct StopWatch {
    cpu: cpu_time::ProcessTime,
    wall: std::time::Instant,
}

#[cfg(any(unix, windows))]
impl StopWatch {
    fn start() -> Self {
        StopWatch { cpu: cpu_time::ProcessTime::now(), wall: std::time::Instant::now() }
    }

    fn read(&self) -> ElapsedTime {
        ElapsedTime { cpu: self.cpu.elapsed(), wall: self.wall.elapsed() }
    }
}

/// A stop watch without a clock: without an operating system there are no clocks.
#[cfg(not(any(unix, windows)))]
struct StopWatch;

#[cfg(not(any(unix, windows)))]
impl StopWatch {
    fn start() -> Self {
        StopWatch
    }

    fn read(&self) -> ElapsedTime {
        ElapsedTime::default()
    }
}

/// Refuses to measure times without clocks.
pub(crate) fn need_clocks() -> Result<()> {
    if cfg!(any(unix, windows)) {
        return Ok(());
    }
    ErrorKind::Option
        .refuse("found --timings where the program has no clock, expected to run on an operating system: leave it out")
}

/// Times of consecutive parts.
pub(crate) struct Timings {
    watch: StopWatch,
    parts: Vec<(&'static str, ElapsedTime)>,
}

impl Timings {
    pub(crate) fn start() -> Self {
        Timings { watch: StopWatch::start(), parts: Vec::new() }
    }

    /// Ends a part, unless it has ended.
    pub(crate) fn end(&mut self, part: &'static str) {
        if self.parts.iter().any(|(ended, _)| *ended == part) {
            return;
        }
        self.parts.push((part, self.watch.read()));
        self.watch = StopWatch::start();
    }

    /// One line of JSON. `solve` is timed alone, as the median of repetitions, and subtracted from `start`, which contained it.
    pub(crate) fn line(&self, solve: impl Fn() -> Summary) -> String {
        let (solved, repeats, iterations) = time_repeated(&solve);
        let mut object = serde_json::Map::new();
        for &(part, span) in &self.parts {
            if part == "start" {
                object.insert(part.to_owned(), span.minus(solved).json());
                let mut entry = solved.json();
                entry["iterations"] = iterations.into();
                entry["repeats"] = repeats.into();
                object.insert("solve".to_owned(), entry);
            } else {
                object.insert(part.to_owned(), span.json());
            }
        }
        Value::Object(object).to_string()
    }
}

/// Median of repeated solves, their number, and the iterations of each.
fn time_repeated(solve: &impl Fn() -> Summary) -> (ElapsedTime, usize, usize) {
    let begin = StopWatch::start();
    let (mut cpu, mut wall, mut iterations) = (Vec::new(), Vec::new(), 0);
    while cpu.len() < FEWEST_REPEATS || (begin.read().wall < LONG_ENOUGH && cpu.len() < MOST_REPEATS) {
        let watch = StopWatch::start();
        iterations = solve().iterations;
        let span = watch.read();
        cpu.push(span.cpu);
        wall.push(span.wall);
    }
    let median = |times: &mut Vec<Duration>| {
        times.sort();
        times.get(times.len() / 2).copied().unwrap_or_default()
    };
    let repeats = cpu.len();
    (ElapsedTime { cpu: median(&mut cpu), wall: median(&mut wall) }, repeats, iterations)
}
