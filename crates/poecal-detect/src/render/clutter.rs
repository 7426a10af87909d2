//! Pictures without a board.

use nalgebra::Vector2;

use super::random::RandomGenerator;
use crate::gray::Gray;

/// A background of a workshop: a gradient of light with bars, discs, stripes, labels and tiles in all sizes, without blur and noise.
#[must_use]
pub fn clutter([width, height]: [usize; 2], random: &mut RandomGenerator) -> Gray {
    let (left, right, lower) =
        (random.draw_uniform(20.0, 200.0), random.draw_uniform(20.0, 200.0), random.draw_uniform(-40.0, 40.0));
    let mut picture = Gray::from_level(width, height, 0.0);
    for (at, level) in picture.levels_mut().iter_mut().enumerate() {
        let (x, y) = ((at % width) as f64 / width as f64, (at / width) as f64 / height as f64);
        *level = (left + (right - left) * x + lower * y).clamp(0.0, 255.0) as f32;
    }
    let shapes = 15 + random.draw_below(25);
    for _ in 0..shapes {
        let shape = ClutterShape::random([width, height], random);
        shape.paint(&mut picture);
    }
    picture
}

/// Pattern inside a turned rectangle.
enum Fill {
    Plain,
    Disc,
    Stripes(f64),
    /// Random cells, as of letters or markers.
    Cells(usize, u64),
    /// A field of squares in both directions: tiles, grids.
    Tiles(f64),
    Dots(f64),
}

struct ClutterShape {
    middle: Vector2<f64>,
    half: [f64; 2],
    turn: f64,
    levels: [f64; 2],
    fill: Fill,
}

impl ClutterShape {
    fn random([width, height]: [usize; 2], random: &mut RandomGenerator) -> Self {
        let long = random.draw_uniform(2.5, 5.6).exp();
        let fill = match random.draw_below(10) {
            0..=3 => Fill::Plain,
            4 => Fill::Disc,
            5 => Fill::Stripes(random.draw_uniform(4.0, 40.0)),
            6 | 7 => Fill::Cells(4 + random.draw_below(6), random.draw_uniform(0.0, 1e15) as u64),
            8 => Fill::Tiles(random.draw_uniform(10.0, 40.0)),
            _ => Fill::Dots(random.draw_uniform(8.0, 40.0)),
        };
        ClutterShape {
            middle: Vector2::new(random.draw_uniform(0.0, width as f64), random.draw_uniform(0.0, height as f64)),
            half: [long, long * random.draw_uniform(0.2, 1.0)],
            turn: random.draw_uniform(0.0, 3.2),
            levels: [random.draw_uniform(5.0, 250.0), random.draw_uniform(5.0, 250.0)],
            fill,
        }
    }

    fn paint(&self, picture: &mut Gray) {
        let reach = self.half[0].hypot(self.half[1]);
        let (width, height) = (picture.width(), picture.height());
        let span = |middle: f64, size: usize| {
            ((middle - reach).max(0.0) as usize).min(size)..((middle + reach).max(0.0) as usize + 1).min(size)
        };
        for row in span(self.middle.y, height) {
            for column in span(self.middle.x, width) {
                if let Some(level) = self.level(Vector2::new(column as f64, row as f64)) {
                    picture.levels_mut()[row * width + column] = level as f32;
                }
            }
        }
    }

    fn level(&self, place: Vector2<f64>) -> Option<f64> {
        let (sin, cos) = self.turn.sin_cos();
        let off = place - self.middle;
        let (x, y) = (cos * off.x + sin * off.y, cos * off.y - sin * off.x);
        if x.abs() > self.half[0] || y.abs() > self.half[1] {
            return None;
        }
        let odd = |value: f64| value.floor() as i64 & 1 == 1;
        let second = match self.fill {
            Fill::Plain => false,
            Fill::Disc => {
                if (x / self.half[0]).hypot(y / self.half[1]) > 1.0 {
                    return None;
                }
                false
            }
            Fill::Stripes(pitch) => odd(x / pitch),
            Fill::Cells(cells, bits) => {
                let cell = |value: f64, half: f64| {
                    ((value / half + 1.0) / 2.0 * cells as f64).clamp(0.0, cells as f64 - 1.0) as usize
                };
                let (column, row) = (cell(x, self.half[0]), cell(y, self.half[1]));
                let border = column == 0 || row == 0 || column + 1 == cells || row + 1 == cells;
                !border && bits >> ((row * cells + column) % 47) & 1 == 1
            }
            Fill::Tiles(pitch) => odd(x / pitch) != odd(y / pitch),
            Fill::Dots(pitch) => {
                let away = |value: f64| (value / pitch).rem_euclid(1.0) - 0.5;
                away(x).hypot(away(y)) < 0.3
            }
        };
        Some(self.levels[usize::from(second)])
    }
}
