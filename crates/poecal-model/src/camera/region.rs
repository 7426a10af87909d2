//! Region of a sensor in its pictures, as `camera_info` of ROS states it beside the lens of the whole sensor.

use super::Lens;

/// A region of a sensor whose pixels are joined in rectangles. The matrix `K` is that of the whole sensor, as `sensor_msgs/CameraInfo` has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Region {
    /// First pixel of the region.
    offset_px: [f64; 2],
    /// Width and height of the region; 0 for the whole sensor.
    size_px: [f64; 2],
    /// Pixels that are joined to one along each axis.
    binning: [f64; 2],
}

/// Keys of the numbers of a region.
pub const KEYS: [&str; 6] = ["roi.x_offset", "roi.y_offset", "roi.width", "roi.height", "binning_x", "binning_y"];

impl Region {
    /// A region by the numbers of its keys, in the order of [`KEYS`]; 0 of a key that is absent.
    ///
    /// # Errors
    /// A message, if numbers are none of a region.
    pub fn new(numbers: [f64; 6]) -> Result<Self, String> {
        let is_wrong = |it: &f64| *it < 0.0 || it.fract() != 0.0 || *it > f64::from(u32::MAX);
        if let Some((keys, number)) = KEYS.iter().zip(numbers).find(|(_, number)| is_wrong(number)) {
            return Err(format!("found {number} for `{keys}`, expected a count of pixels"));
        }
        let [x, y, width, height, by_x, by_y] = numbers;
        if (width == 0.0) != (height == 0.0) {
            return Err(format!(
                "found a region `roi` of {width} × {height} pixels, expected both above 0, or both 0 for all of the sensor"
            ));
        }
        // 0 is the same as 1 in ROS.
        Ok(Region { offset_px: [x, y], size_px: [width, height], binning: [by_x.max(1.0), by_y.max(1.0)] })
    }

    /// Lens of the pictures of the region, from that of the whole sensor, with a note on the change if there is one.
    ///
    /// # Errors
    /// A message, if the region is not on the sensor.
    pub fn apply_region(&self, lens: &Lens) -> Result<(Lens, Option<String>), String> {
        let Region { offset_px, size_px, binning } = *self;
        let is_part = size_px[0] > 0.0;
        let whole = lens.size_px.map(|it| it.map(f64::from));
        if let Some(whole) = whole.filter(|whole| is_part && (0..2).any(|k| offset_px[k] + size_px[k] > whole[k])) {
            let ([width, height], [x, y], [most_x, most_y]) = (size_px, offset_px, whole);
            return Err(format!(
                "found a region `roi` of {width} × {height} pixels from ({x}, {y}) on, expected one inside the sensor of {most_x} × {most_y}"
            ));
        }
        let size = if is_part { Some(size_px) } else { whole };
        if offset_px == [0.0; 2] && binning == [1.0; 2] && (size == whole || whole.is_none()) {
            return Ok((*lens, None));
        }
        let seen = Lens {
            focal_px: [0, 1].map(|k| lens.focal_px[k] / binning[k]),
            centre_px: [0, 1].map(|k| (lens.centre_px[k] - offset_px[k]) / binning[k]),
            size_px: size.map(|size| [0, 1].map(|k| (size[k] / binning[k]) as u32)),
            ..*lens
        };
        let mut done = Vec::new();
        if is_part || offset_px != [0.0; 2] {
            done.push(format!("the region `roi` from ({}, {}) on", offset_px[0], offset_px[1]));
        }
        if binning != [1.0; 2] {
            done.push(format!("the binning {} × {}", binning[0], binning[1]));
        }
        let size = seen.size_px.map_or(String::new(), |[width, height]| format!(" of {width} × {height} pixels"));
        let ([fx, fy], [cx, cy]) = (seen.focal_px, seen.centre_px);
        let words = format!(
            "took the lens as that of pictures{size}, by {}: fx {fx:.2}, fy {fy:.2}, cx {cx:.2}, cy {cy:.2} px",
            done.join(" and ")
        );
        Ok((seen, Some(words)))
    }
}
