//! Observable motions of a frame.

/// Motions of a frame, along and about its own axes, that some measurements determine, a bit each. The others are unobservable, and a fit does
/// not change them (theory.md §5 (25a)).
///
/// ```
/// use poecal_arm::lie::Freedom;
/// assert_eq!((Freedom::PLACE.motions(), Freedom::plane(2).motions()), (&[0, 1, 2][..], &[2, 3, 4][..]));
/// assert_eq!(Freedom::PLACE.union(Freedom::tilt(2)).count(), 5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Freedom(u8);

/// Motions of every set of them.
const MOTIONS: [[usize; 6]; Freedom::SETS] = {
    let mut all = [[0; 6]; Freedom::SETS];
    let mut set = 0;
    while set < Freedom::SETS {
        let (mut motion, mut count) = (0, 0);
        while motion < 6 {
            if set >> motion & 1 == 1 {
                all[set][count] = motion;
                count += 1;
            }
            motion += 1;
        }
        set += 1;
    }
    all
};

impl Freedom {
    /// Number of sets of motions.
    pub const SETS: usize = 64;
    /// All six: a position and the axes there.
    pub const FRAME: Freedom = Freedom(0b11_1111);
    /// Position: a point.
    pub const PLACE: Freedom = Freedom(0b00_0111);
    /// Orientation.
    pub const TURN: Freedom = Freedom(0b11_1000);

    /// A face across an axis (0 to 2): its height along it, and its tilts about the other two.
    #[must_use]
    pub const fn plane(axis: usize) -> Freedom {
        Freedom(1 << axis | Freedom::tilt(axis).0)
    }

    /// The direction of an axis: the tilts of a face across it.
    #[must_use]
    pub const fn tilt(axis: usize) -> Freedom {
        Freedom(Freedom::TURN.0 & !(1 << (3 + axis)))
    }

    /// All motions except the translation along an axis.
    #[must_use]
    pub const fn without_slide(axis: usize) -> Freedom {
        Freedom(Freedom::FRAME.0 & !(1 << axis))
    }

    /// The set of these motions.
    #[must_use]
    pub fn from_motions(motions: impl IntoIterator<Item = usize>) -> Freedom {
        Freedom(motions.into_iter().fold(0, |all, motion| all | 1 << motion))
    }

    /// The motions, as indices: three translations along x, y, z, three rotations about them.
    #[must_use]
    pub const fn motions(self) -> &'static [usize] {
        MOTIONS[self.index()].split_at(self.count()).0
    }

    /// Index among all sets of motions.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// Number of motions.
    #[must_use]
    pub const fn count(self) -> usize {
        self.0.count_ones() as usize
    }

    /// True if some are rotations.
    #[must_use]
    pub const fn turns(self) -> bool {
        self.0 & Freedom::TURN.0 != 0
    }

    /// The same without the height of a plane.
    #[must_use]
    pub fn without_height(self) -> Freedom {
        let plane = (0..3).find(|axis| self == Freedom::plane(*axis));
        plane.map_or(self, Freedom::tilt)
    }

    /// These motions and others.
    #[must_use]
    pub const fn union(self, other: Freedom) -> Freedom {
        Freedom(self.0 | other.0)
    }
}
