//! Tools and frames that a program does not state.

use super::Language;
use super::forms::PoseForm;
use poecal_arm::lie::Pose;
use poecal_numerics::error::{ErrorKind, Result};

/// Tools and frames of the controller, stated by the user.
#[derive(Clone, Debug)]
pub struct StatedFrames {
    /// Tools by number or name, `flange_from_tcp`; without one, the tool of programs that set none.
    pub tools: Vec<(Option<String>, Pose)>,
    /// Frames (work objects, bases) by number or name, `base_from_frame`; without one, the frame of programs that set none.
    pub frames: Vec<(Option<String>, Pose)>,
    /// `model_from_base`: the controller's base in the base of the model.
    pub base: Pose,
    /// `tip_from_flange`: the controller's flange in the tip of the model.
    pub flange: Pose,
    /// Readings (rad, m) of the robot before the program's first motion.
    pub start: Option<Vec<f64>>,
}

impl Default for StatedFrames {
    fn default() -> Self {
        let (base, flange) = (Pose::identity(), Pose::identity());
        StatedFrames { tools: Vec::new(), frames: Vec::new(), base, flange, start: None }
    }
}

impl StatedFrames {
    /// The tools and frames for a taught robot in place of the nominal one, with its base in that of the model, and its tool.
    #[must_use]
    pub fn with_taught_frames(self, base: &Pose, tool: &Pose) -> Self {
        StatedFrames { base: *base * self.base, flange: tool.inverse() * self.flange, ..self }
    }

    /// A tool by its number or name (case does not matter), or the one without.
    #[must_use]
    pub fn tool(&self, name: Option<&str>) -> Option<Pose> {
        find_named(&self.tools, name)
    }

    /// A frame by its number or name (case does not matter), or the one without.
    #[must_use]
    pub fn frame(&self, name: Option<&str>) -> Option<Pose> {
        find_named(&self.frames, name)
    }
}

fn find_named(poses: &[(Option<String>, Pose)], name: Option<&str>) -> Option<Pose> {
    let small = |it: Option<&str>| it.map(str::to_ascii_lowercase);
    poses.iter().find(|(it, _)| small(it.as_deref()) == small(name)).map(|(_, pose)| *pose)
}

impl StatedFrames {
    /// Adds a tool in words: `[NAME=]NUMBERS`, the numbers in the language's form of poses.
    ///
    /// # Errors
    /// [`ErrorKind::Option`].
    pub fn add_tool(&mut self, words: &str, language: Language) -> Result<()> {
        let found = named_pose(words, language, "--tool-data")?;
        add(&mut self.tools, found, words, "--tool-data")
    }

    /// Adds a frame in words: `[NAME=]NUMBERS`, the numbers in the language's form of poses.
    ///
    /// # Errors
    /// [`ErrorKind::Option`].
    pub fn add_frame(&mut self, words: &str, language: Language) -> Result<()> {
        let found = named_pose(words, language, "--work-object")?;
        add(&mut self.frames, found, words, "--work-object")
    }

    /// Sets the controller's base in the model's, by numbers in the language's form of poses.
    ///
    /// # Errors
    /// [`ErrorKind::Option`].
    pub fn set_base(&mut self, words: &str, language: Language) -> Result<()> {
        self.base = plain_pose(words, language, "--controller-base")?;
        Ok(())
    }

    /// Sets the controller's flange in the model's tip, by numbers in the language's form of poses.
    ///
    /// # Errors
    /// [`ErrorKind::Option`].
    pub fn set_flange(&mut self, words: &str, language: Language) -> Result<()> {
        self.flange = plain_pose(words, language, "--controller-flange")?;
        Ok(())
    }
}

type NamedPose = (Option<String>, Pose);

impl StatedFrames {
    /// Sets the configuration before the first motion, by numbers in the language's form of joints.
    ///
    /// # Errors
    /// [`ErrorKind::Option`].
    pub fn set_start(&mut self, words: &str, language: Language) -> Result<()> {
        let (scale, unit) = match language {
            Language::UrScript => (1.0, "radians"),
            Language::Rapid | Language::Krl | Language::Fanuc => (1_f64.to_radians(), "degrees"),
        };
        let Some(numbers) = numbers(words) else {
            return ErrorKind::Option
                .refuse(format!("found --start {words}, expected the readings of all joints, J1,J2,… in {unit}"));
        };
        self.start = Some(numbers.iter().map(|it| it * scale).collect());
        Ok(())
    }
}

fn add(poses: &mut Vec<NamedPose>, found: NamedPose, words: &str, option: &str) -> Result<()> {
    if find_named(poses, found.0.as_deref()).is_some() {
        return ErrorKind::Option
            .refuse(format!("found {option} {words} for one that is stated already, expected each once"));
    }
    poses.push(found);
    Ok(())
}

/// Numbers between commas.
fn numbers(words: &str) -> Option<Vec<f64>> {
    words.split(',').map(|it| it.trim().parse().ok().filter(|it: &f64| it.is_finite())).collect()
}

fn plain_pose(words: &str, language: Language, option: &str) -> Result<Pose> {
    let form = PoseForm::from_language(language);
    let expected = form.names();
    numbers(words).filter(|it| it.len() == expected.len()).and_then(|it| form.pose(&it)).ok_or_else(|| {
        ErrorKind::Option.error(format!(
            "found {option} {words}, expected {} as {} writes poses ({})",
            expected.join(","),
            language.title(),
            language.units()
        ))
    })
}

fn named_pose(words: &str, language: Language, option: &str) -> Result<NamedPose> {
    let (name, numbers) = match words.split_once('=') {
        Some((name, numbers)) if !name.trim().is_empty() => (Some(name.trim().to_owned()), numbers),
        Some(_) | None => (None, words),
    };
    Ok((name, plain_pose(numbers, language, option)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flange_of_a_taught_robot_is_behind_its_tool() {
        let tool = Pose::from_translation([0.0, 0.0, 0.1].into());
        assert_eq!(StatedFrames::default().with_taught_frames(&Pose::identity(), &tool).flange.translation.z, -0.1);
    }
}
