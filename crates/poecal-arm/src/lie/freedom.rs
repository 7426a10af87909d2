//! Which motions of a frame are seen.

/// The motions of a frame, along and about its own axes, that some measurements show; of the others nothing can be known, and a fit leaves
/// them as they are (theory.md §5 (25a)).
///
/// ```
/// use poecal_arm::lie::Freedom;
/// assert_eq!((Freedom::Place.motions(), Freedom::PlaneZ.motions()), (&[0, 1, 2][..], &[2, 3, 4][..]));
/// assert_eq!(Freedom::Place.with(Freedom::Direction), Freedom::Frame);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freedom {
    /// All six: a place and the axes there.
    Frame,
    /// Where it is: a point.
    Place,
    /// A plane across x: its height along x, and its tilts about y and z.
    PlaneX,
    /// A plane across y.
    PlaneY,
    /// A plane across z.
    PlaneZ,
    /// All but its place along x.
    AcrossX,
    /// All but its place along y.
    AcrossY,
    /// All but its place along z.
    AcrossZ,
    /// How it is turned.
    Turn,
    /// The direction of x: the tilts of a face across x.
    TiltX,
    /// The direction of y.
    TiltY,
    /// The direction of z.
    Direction,
}

impl Freedom {
    /// All of them, the one of fewest motions first.
    pub const ALL: [Freedom; 12] = [
        Freedom::Direction,
        Freedom::TiltX,
        Freedom::TiltY,
        Freedom::Place,
        Freedom::PlaneX,
        Freedom::PlaneY,
        Freedom::PlaneZ,
        Freedom::Turn,
        Freedom::AcrossX,
        Freedom::AcrossY,
        Freedom::AcrossZ,
        Freedom::Frame,
    ];

    /// The motions, as indices: three translations along x, y, z, three rotations about them.
    #[must_use]
    pub const fn motions(self) -> &'static [usize] {
        match self {
            Freedom::Frame => &[0, 1, 2, 3, 4, 5],
            Freedom::Place => &[0, 1, 2],
            Freedom::PlaneX => &[0, 4, 5],
            Freedom::PlaneY => &[1, 3, 5],
            Freedom::PlaneZ => &[2, 3, 4],
            Freedom::AcrossX => &[1, 2, 3, 4, 5],
            Freedom::AcrossY => &[0, 2, 3, 4, 5],
            Freedom::AcrossZ => &[0, 1, 3, 4, 5],
            Freedom::Turn => &[3, 4, 5],
            Freedom::TiltX => &[4, 5],
            Freedom::TiltY => &[3, 5],
            Freedom::Direction => &[3, 4],
        }
    }

    /// Their number.
    #[must_use]
    pub const fn count(self) -> usize {
        self.motions().len()
    }

    /// Whether a motion, by its index, is one of them.
    #[must_use]
    pub fn has(self, motion: usize) -> bool {
        self.motions().contains(&motion)
    }

    /// Whether some are rotations.
    #[must_use]
    pub fn turns(self) -> bool {
        self != Freedom::Place
    }

    /// The same without the height of a plane.
    #[must_use]
    pub fn without_height(self) -> Freedom {
        match self {
            Freedom::PlaneX => Freedom::TiltX,
            Freedom::PlaneY => Freedom::TiltY,
            Freedom::PlaneZ => Freedom::Direction,
            Freedom::Frame
            | Freedom::Place
            | Freedom::AcrossX
            | Freedom::AcrossY
            | Freedom::AcrossZ
            | Freedom::Turn
            | Freedom::TiltX
            | Freedom::TiltY
            | Freedom::Direction => self,
        }
    }

    /// What shows these motions and others: the least that has both.
    #[must_use]
    pub fn with(self, other: Freedom) -> Freedom {
        let has_all =
            |it: &Freedom| self.motions().iter().chain(other.motions()).all(|&motion| it.has(motion));
        Freedom::ALL.into_iter().find(has_all).unwrap_or(Freedom::Frame)
    }
}
