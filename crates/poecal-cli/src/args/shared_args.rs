//! Arguments of several commands.

use std::path::{Path, PathBuf};

use clap::Args;
use poecal_formats::urdf::{ChainSelection, named_link};
use poecal_import::{
    ColumnMap, FrameGrouping, InstrumentNoise, Join, Lag, PlaneContact, ReadOptions, SocketDistances, camera_file,
};
use poecal_numerics::error::ErrorKind;
use poecal_results::output::{ExistingFiles, ReservedFile};
use poecal_storage::disk::is_file;

use crate::console::Console;
use crate::words::{CONTACT, FRAMES, JOIN, one_of};

/// Headings of options that several commands have: of the model's links, of measurement files, of the fit, of what judges it, and of results.
const LINKS: &str = "Links of the model";
const FILES: &str = "Measurement files";
pub(super) const FIT: &str = "Fit";
pub(super) const JUDGED: &str = "How it is judged";
pub(super) const RESULTS: &str = "Results";

/// Which chain of a URDF.
#[derive(Args, Debug)]
#[command(next_help_heading = LINKS)]
pub(crate) struct ChainArgs {
    /// First link of the chain, where a URDF has several
    #[arg(long, value_name = "LINK")]
    pub(crate) base_link: Option<String>,
    /// Last link of the chain, where a URDF has several
    #[arg(long, value_name = "LINK")]
    pub(crate) tip_link: Option<String>,
}

impl ChainArgs {
    pub(crate) fn selection(&self) -> ChainSelection {
        let (base_link, tip_link) = (self.base_link.clone(), self.tip_link.clone());
        ChainSelection { base_link, tip_link, ..ChainSelection::default() }
    }

    /// Refuses links of a model that is not stated.
    pub(crate) fn refuse_without(&self, model: Option<&Path>) -> poecal_numerics::error::Result<()> {
        if model.is_none() && (self.base_link.is_some() || self.tip_link.is_some()) {
            let message = "found --base-link or --tip-link and no model, expected --robot MODEL with them";
            return ErrorKind::Option.refuse(message);
        }
        Ok(())
    }
}

/// Which chain or tree of a URDF.
#[derive(Args, Debug)]
#[command(next_help_heading = LINKS)]
pub(crate) struct TreeArgs {
    #[command(flatten)]
    pub(crate) chain: ChainArgs,
    /// Instrument on the robot, as rows name it, and its link in a URDF (repeatable). The robot is then the tree of all joints between the
    /// base and the named links
    #[arg(long, value_name = "NAME=LINK", value_parser = named_link)]
    pub(crate) instrument: Vec<(String, String)>,
    /// Target, as rows name it, and its link in a URDF (repeatable), likewise. Without --tip-link, the first that a joint moves is the tip
    #[arg(long, value_name = "NAME=LINK", value_parser = named_link)]
    pub(crate) target: Vec<(String, String)>,
}

impl TreeArgs {
    /// The selection; with the links of a mapping, if it could be read.
    pub(crate) fn selection(&self, options: Option<&ReadOptions>) -> poecal_numerics::error::Result<ChainSelection> {
        with_mapping(self.chain.selection().join(&self.instrument, &self.target)?, options)
    }
}

/// A selection with the links of a mapping, if it could be read.
pub(crate) fn with_mapping(
    selection: ChainSelection,
    options: Option<&ReadOptions>,
) -> poecal_numerics::error::Result<ChainSelection> {
    match options.and_then(|options| options.mapping.as_ref()) {
        Some(mapping) => mapping.mounts(selection),
        None => Ok(selection),
    }
}

/// Meaning of columns in files.
#[derive(Args, Debug)]
#[command(next_help_heading = FILES)]
pub(crate) struct ColumnArgs {
    /// Mapping file for files with other column names
    #[arg(long, value_name = "MAP.toml")]
    pub(crate) columns: Option<PathBuf>,
    /// Units of columns that state none, like mm,deg; a mapping file takes precedence
    #[arg(long, value_name = "UNIT[,UNIT]")]
    pub(crate) units: Option<String>,
}

impl ColumnArgs {
    pub(crate) fn options(&self) -> poecal_numerics::error::Result<ReadOptions> {
        let mapping = self.columns.as_ref().map(ColumnMap::read).transpose()?;
        let mut options = ReadOptions { mapping, ..ReadOptions::default() };
        self.units.as_deref().map_or(Ok(()), |units| options.state_units(units))?;
        Ok(options)
    }
}

/// Cameras and boards of corners in pixels.
#[derive(Args, Debug)]
#[command(next_help_heading = FILES)]
pub(crate) struct CameraArgs {
    /// Cameras of corners in pixels: CSV with name, fx, fy, cx, cy, k1 and so on in OpenCV's order (FILE#VERSION where it has several), YAML, JSON
    /// or XML of OpenCV, ROS, Kalibr, ViSP, mrcal and makers of cameras, .dat of HALCON, a calibration.json with what it found, or unknown:1920x1080
    /// with the size of the pictures, for a lens that is found from them; may be given again
    #[arg(long, value_name = "FILE[#VERSION]|unknown:WxH")]
    pub(crate) camera: Vec<String>,
    /// Board or solid that cameras see: CSV with target, x[mm], y[mm], z[mm] of its points, chessboard:10x7:27mm (squares along x and y, and
    /// their side), charuco:, circles:, aprilgrid: or tags: as poecal detect has them, YAML of Kalibr or industrial_calibration, settings of OpenCV
    /// (YAML, XML), or a calibration.json with what it found; may be given again
    #[arg(long, value_name = "FILE|BOARD")]
    pub(crate) markers: Vec<String>,
}

impl CameraArgs {
    /// The files that they are read from.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        let camera = self.camera.iter().filter_map(|typed| camera_file(typed)).map(|(path, _)| path);
        camera.chain(self.markers.iter().map(Path::new).filter(|path| is_file(path)))
    }

    /// The same options with these cameras and boards.
    pub(crate) fn add(&self, mut options: ReadOptions) -> poecal_numerics::error::Result<ReadOptions> {
        for typed in &self.camera {
            options.add_cameras(typed)?;
        }
        for typed in &self.markers {
            options.add_boards(typed)?;
        }
        Ok(options)
    }
}

/// Meaning of measurement files.
#[derive(Args, Debug)]
#[command(next_help_heading = FILES)]
pub(crate) struct MeaningArgs {
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    /// Refuse lost beams (empty or zero positions) instead of skipping them with a warning
    #[arg(long)]
    pub(crate) strict: bool,
    /// Which rows share a frame of the measuring device: per-file if it was moved between the files
    #[arg(long, value_parser = one_of(FRAMES), default_value = "common")]
    pub(crate) device_frames: FrameGrouping,
    /// Match of rows of a joint file with rows of a measurement file [default: by name, else recordings by the times at which the robot stood still and
    /// lists by their order, if the nominal model fits no other match as well]
    #[arg(long, value_parser = one_of(JOIN))]
    pub(crate) join: Option<Join>,
    /// Clock offset of two recordings, the measurements' time less that of the joint readings, where several fit [default: found]
    #[arg(long, value_name = "SECONDS[+-SECONDS]", allow_hyphen_values = true)]
    pub(crate) lag: Option<Lag>,
    /// Sheet of workbooks [default: the only one that holds a table]
    #[arg(long, value_name = "NAME")]
    pub(crate) sheet: Option<String>,
    /// Body, marker or tool of recordings of a camera system [default: the only one that moves]
    #[arg(long, value_name = "NAME")]
    pub(crate) body: Option<String>,
    /// Topic of ROS 2 bags that has the joint readings or the measurements, where several can be meant; may be given again [default: the only one]
    #[arg(long, value_name = "NAME")]
    pub(crate) topic: Vec<String>,
    /// Known distance between the two sockets of each place, like 50mm, or of pairs by name, like A-B=50mm,B-C=70mm+-0.02mm
    #[arg(long, value_name = "LENGTH|A-B=LENGTH,...")]
    pub(crate) socket_distance: Option<SocketDistances>,
    /// Kind of contact for rows whose `contact` cell is empty: touched by a point, or by a face that lies flush
    #[arg(long, value_parser = one_of(CONTACT), default_value = "point")]
    pub(crate) contact: PlaneContact,
    /// Noise of an instrument that grows with the distance, like tracker:10um+5um/m: a standard deviation in all directions, and one across the
    /// line of sight for each metre; of all instruments without a name. For rows that state none; may be given again
    #[arg(long, value_name = "[NAME:]LENGTH+LENGTH/m")]
    pub(crate) instrument_noise: Vec<InstrumentNoise>,
    #[command(flatten)]
    pub(crate) cameras: CameraArgs,
}

impl MeaningArgs {
    /// The files that say what others mean.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        self.columns.columns.iter().map(PathBuf::as_path).chain(self.cameras.files())
    }

    pub(crate) fn options(&self) -> poecal_numerics::error::Result<ReadOptions> {
        let (strict, frames, contact) = (self.strict, self.device_frames, self.contact);
        let socket_distances = self.socket_distance.clone();
        let instrument_noise = self.instrument_noise.clone();
        let options = ReadOptions {
            strict,
            frames,
            join: self.join,
            lag: self.lag,
            sheet: self.sheet.clone(),
            body: self.body.clone(),
            topics: self.topic.clone(),
            contact,
            socket_distances,
            instrument_noise,
            ..self.columns.options()?
        };
        self.cameras.add(options)
    }
}

/// Options for reading measurement files.
#[derive(Args, Debug)]
#[command(next_help_heading = FILES)]
pub(crate) struct ReadingArgs {
    #[command(flatten)]
    pub(crate) meaning: MeaningArgs,
    /// Fit only rows whose COLUMN has one of these values, and hold out all others
    #[arg(long, value_name = "COLUMN=VALUE[,VALUE]")]
    pub(crate) train_where: Option<String>,
}

impl ReadingArgs {
    pub(crate) fn options(&self) -> poecal_numerics::error::Result<ReadOptions> {
        let train_where = self.train_where.as_deref().map(str::parse).transpose()?;
        Ok(ReadOptions { train_where, ..self.meaning.options()? })
    }
}

/// Destination of a text.
#[derive(Args, Debug)]
#[command(next_help_heading = RESULTS)]
pub(crate) struct TextOutput {
    /// File to write; a device or a pipe is written to as it is [default: standard output]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Write over a file that exists
    #[arg(long)]
    pub(crate) force: bool,
}

impl TextOutput {
    /// Place of the output, which may be no input; `None` for standard output.
    pub(crate) fn reserve(
        &self,
        inputs: &[&Path],
        console: &Console,
    ) -> poecal_numerics::error::Result<Option<ReservedFile>> {
        let out = self.out.as_deref().filter(|out| *out != Path::new("-"));
        out.map(|out| ReservedFile::reserve(out, ExistingFiles::from_switch(self.force), inputs, &mut console.warner()))
            .transpose()
    }
}
