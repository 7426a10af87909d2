//! Messages of ROS 2 that hold joint readings or poses.

use super::cdr::CdrReader;

/// Kind of content of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MessageKind {
    Joints,
    Pose,
    Point,
    Transform,
    Transforms,
}

/// Types of messages that are read.
const TYPES: [(&str, MessageKind); 5] = [
    ("sensor_msgs/msg/JointState", MessageKind::Joints),
    ("geometry_msgs/msg/PoseStamped", MessageKind::Pose),
    ("geometry_msgs/msg/PointStamped", MessageKind::Point),
    ("geometry_msgs/msg/TransformStamped", MessageKind::Transform),
    ("tf2_msgs/msg/TFMessage", MessageKind::Transforms),
];

impl MessageKind {
    /// The kind by the name of a type.
    pub(crate) fn from_type_name(name: &str) -> Option<Self> {
        let is_same = |known: &str| known == name || known.replace("/msg/", "/") == name;
        TYPES.iter().find(|it| is_same(it.0)).map(|it| it.1)
    }

    /// True if such a message has an orientation.
    pub(crate) fn is_posed(self) -> bool {
        self != MessageKind::Point
    }
}

/// The readings of a message: the position of each name, if there are positions.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct JointState<'m> {
    /// Time, nanoseconds; 0 if it was not set.
    pub(crate) stamp_ns: i64,
    pub(crate) names: Vec<&'m str>,
    pub(crate) positions: Vec<f64>,
}

/// Pose of a body in a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PoseField<'m> {
    /// Time, nanoseconds; 0 if it was not set.
    pub(crate) stamp_ns: i64,
    /// The frame in which the pose is expressed.
    pub(crate) parent: &'m str,
    /// The body whose pose it is; empty if the message does not name it.
    pub(crate) child: &'m str,
    pub(crate) position: [f64; 3],
    /// Quaternion x, y, z, w.
    pub(crate) quaternion: [f64; 4],
}

/// Time and frame of a message.
fn head<'m>(cdr: &mut CdrReader<'m>) -> Result<(i64, &'m str), String> {
    let (seconds, nanoseconds) = (cdr.i32()?, cdr.u32()?);
    Ok((i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds), cdr.text()?))
}

/// The readings of a message.
pub(crate) fn joint_state(message: &[u8]) -> Result<JointState<'_>, String> {
    let mut cdr = CdrReader::new(message)?;
    let (stamp_ns, _) = head(&mut cdr)?;
    let (names, positions) = (cdr.texts()?, cdr.numbers()?);
    // Velocities and efforts follow.
    cdr.numbers()?;
    cdr.numbers()?;
    if !positions.is_empty() && positions.len() != names.len() {
        return Err(format!("{} names and {} positions", names.len(), positions.len()));
    }
    Ok(JointState { stamp_ns, names, positions })
}

/// The poses of a message of this kind.
pub(crate) fn poses(kind: MessageKind, message: &[u8]) -> Result<Vec<PoseField<'_>>, String> {
    /// Least bytes of a transform.
    const TRANSFORM: usize = 72;
    let mut cdr = CdrReader::new(message)?;
    let count = if kind == MessageKind::Transforms { cdr.count(TRANSFORM)? } else { 1 };
    let mut one = || {
        let (stamp_ns, parent) = head(&mut cdr)?;
        let is_named = matches!(kind, MessageKind::Transform | MessageKind::Transforms);
        let child = if is_named { cdr.text()? } else { "" };
        let position = cdr.array()?;
        let quaternion = if kind.is_posed() { cdr.array()? } else { [0.0; 4] };
        Ok(PoseField { stamp_ns, parent, child, position, quaternion })
    };
    (0..count).map(|_| one()).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Writes CDR, little endian.
    #[derive(Default)]
    pub(crate) struct Writer(Vec<u8>);

    impl Writer {
        fn align(&mut self, to: usize) {
            self.0.resize(self.0.len().next_multiple_of(to), 0);
        }

        fn count(&mut self, count: usize) {
            self.align(4);
            self.0.extend(u32::try_from(count).unwrap().to_le_bytes());
        }

        fn text(&mut self, text: &str) {
            self.count(text.len() + 1);
            self.0.extend(text.as_bytes());
            self.0.push(0);
        }

        fn numbers(&mut self, numbers: &[f64]) {
            for it in numbers {
                self.align(8);
                self.0.extend(it.to_le_bytes());
            }
        }

        fn head(&mut self, stamp_ns: u64, frame: &str) {
            self.count((stamp_ns / 1_000_000_000) as usize);
            self.count((stamp_ns % 1_000_000_000) as usize);
            self.text(frame);
        }

        fn message(self) -> Vec<u8> {
            [&[0, 1, 0, 0][..], &self.0].concat()
        }

        /// Readings of joints.
        pub(crate) fn joints(stamp_ns: u64, joints: &[(&str, f64)]) -> Vec<u8> {
            let mut out = Writer::default();
            out.head(stamp_ns, "");
            out.count(joints.len());
            joints.iter().for_each(|it| out.text(it.0));
            out.count(joints.len());
            joints.iter().for_each(|it| out.numbers(&[it.1]));
            out.count(0);
            out.count(0);
            out.message()
        }

        /// A pose: three numbers of the position, four of the quaternion.
        pub(crate) fn pose(stamp_ns: u64, numbers: &[f64]) -> Vec<u8> {
            let mut out = Writer::default();
            out.head(stamp_ns, "world");
            out.numbers(numbers);
            out.message()
        }

        /// Transforms of frames in `world`.
        pub(crate) fn transforms(stamp_ns: u64, frames: &[(&str, [f64; 7])]) -> Vec<u8> {
            let mut out = Writer::default();
            out.count(frames.len());
            for (name, numbers) in frames {
                out.head(stamp_ns, "world");
                out.text(name);
                out.numbers(numbers);
            }
            out.message()
        }
    }

    #[test]
    fn messages_are_read_as_they_are_written() {
        let written = Writer::joints(3_000_000_005, &[("gripper", 0.5), ("a", -1.0)]);
        let read = joint_state(&written).unwrap();
        assert_eq!((read.stamp_ns, read.names), (3_000_000_005, vec!["gripper", "a"]));
        assert_eq!(read.positions, [0.5, -1.0]);
        let numbers = [1.0, 2.0, 3.0, 0.0, 0.0, 0.6, 0.8];
        for kind in [MessageKind::Pose, MessageKind::Point] {
            let written = Writer::pose(7, &numbers);
            let read = poses(kind, &written).unwrap();
            let one = read.first().unwrap();
            assert_eq!((one.stamp_ns, one.parent, one.position), (7, "world", [1.0, 2.0, 3.0]));
            assert_eq!(one.quaternion == [0.0, 0.0, 0.6, 0.8], kind.is_posed());
        }
        let written = Writer::transforms(9, &[("tool", numbers), ("base", [0.0; 7])]);
        let read = poses(MessageKind::Transforms, &written).unwrap();
        assert_eq!(read.iter().map(|it| it.child).collect::<Vec<_>>(), ["tool", "base"]);
        assert_eq!(read.first().unwrap().quaternion, [0.0, 0.0, 0.6, 0.8]);
        for size in 0..written.len() {
            assert!(poses(MessageKind::Transforms, &written[..size]).is_err(), "{size}");
        }
    }

    #[test]
    fn types_are_known_in_either_form() {
        assert_eq!(MessageKind::from_type_name("sensor_msgs/msg/JointState"), Some(MessageKind::Joints));
        assert_eq!(MessageKind::from_type_name("geometry_msgs/PoseStamped"), Some(MessageKind::Pose));
        assert_eq!(MessageKind::from_type_name("std_msgs/msg/String"), None);
    }
}
