// Written by web/npm/types.mjs from docs/calibration.schema.json and docs/commands.md.

/** A value of an option, as it would be typed; of an option that may be given again, an array of them. */
export type Value = string | number;

/** Options of `poecal calibrate`, by their long names. */
export interface CalibrateOptions {
  /** Most that a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names) */
  limit?: Value | readonly Value[];
  /** Wait so long, like 60s, for another run that writes to the same folder or ledger [default: refuse at once] */
  wait?: Value | readonly Value[];
  /** First link of the chain, where a URDF has several */
  baseLink?: Value | readonly Value[];
  /** Last link of the chain, where a URDF has several */
  tipLink?: Value | readonly Value[];
  /**
   * Instrument on the robot, as rows name it, and its link in a URDF (repeatable). The robot is then the tree of all joints between the
   * base and the named links
   */
  instrument?: Value | readonly Value[];
  /** Target, as rows name it, and its link in a URDF (repeatable), likewise. Without --tip-link, the first that a joint moves is the tip */
  target?: Value | readonly Value[];
  /** Units of columns that state none, like mm,deg; a mapping file takes precedence */
  units?: Value | readonly Value[];
  /** Refuse lost beams (empty or zero positions) instead of skipping them with a warning */
  strict?: boolean;
  /** Which rows share a frame of the measuring device: per-file if it was moved between the files */
  deviceFrames?: "common" | "per-file";
  /**
   * Match of rows of a joint file with rows of a measurement file [default: by name, else recordings by the times at which the robot stood
   * still and lists by their order, if the nominal model fits no other match as well]
   */
  join?: "name" | "rows" | "time" | "motion";
  /** Clock offset of two recordings, the measurements' time less that of the joint readings, where several fit [default: found] */
  lag?: Value | readonly Value[];
  /** Sheet of workbooks [default: the only one that holds a table] */
  sheet?: Value | readonly Value[];
  /** Body, marker or tool of recordings of a camera system [default: the only one that moves] */
  body?: Value | readonly Value[];
  /**
   * Topic of ROS 2 bags that has the joint readings or the measurements, where several can be meant; may be given again [default: the only
   * one]
   */
  topic?: Value | readonly Value[];
  /** Known distance between the two sockets of each place, like 50mm, or of pairs by name, like A-B=50mm,B-C=70mm+-0.02mm */
  socketDistance?: Value | readonly Value[];
  /** Kind of contact for rows whose `contact` cell is empty: touched by a point, or by a face that lies flush */
  contact?: "point" | "flush";
  /**
   * Noise of an instrument that grows with the distance, like tracker:10um+5um/m: a standard deviation in all directions, and one across
   * the line of sight for each metre; of all instruments without a name. For rows that state none; may be given again
   */
  instrumentNoise?: Value | readonly Value[];
  /**
   * Cameras of corners in pixels: CSV with name, fx, fy, cx, cy, k1 and so on in OpenCV's order (FILE#VERSION where it has several), YAML,
   * JSON or XML of OpenCV, ROS, Kalibr, ViSP, mrcal and makers of cameras, .dat of HALCON, a calibration.json with what it found, or
   * unknown:1920x1080 with the size of the pictures, for a lens that is found from them; may be given again
   */
  camera?: Value | readonly Value[];
  /**
   * Board or solid that cameras see: CSV with target, x[mm], y[mm], z[mm] of its points, chessboard:10x7:27mm (squares along x and y, and
   * their side), charuco:, circles:, aprilgrid: or tags: as poecal detect has them, YAML of Kalibr or industrial_calibration, settings of
   * OpenCV (YAML, XML), or a calibration.json with what it found; may be given again
   */
  markers?: Value | readonly Value[];
  /** Fit only rows whose COLUMN has one of these values, and hold out all others */
  trainWhere?: Value | readonly Value[];
  /** The measuring device's frame */
  deviceFrame?: "unknown" | "base";
  /** Standard deviation of each measured position component, like 0.05mm [default: estimated from the data] */
  sigmaPosition?: Value | readonly Value[];
  /** Standard deviation of each measured rotation component, like 0.01deg [default: estimated from the data] */
  sigmaRotation?: Value | readonly Value[];
  /**
   * Deviations of the axes from the model (the prior): standard deviations of their directions and places, or none. They matter only where
   * the measurements leave an axis open, which then stays near the model. auto chooses by cross-validation among 0.05deg,0.5mm, 0.2deg,2mm,
   * 0.5deg,5mm, 1deg,10mm and 3deg,10mm. A joint of a TOML model may state its own. MOC.cfg of an ABB controller with Absolute Accuracy has
   * the deviations that the maker found [default: 0.5deg,5mm]
   */
  tolerance?: Value | readonly Value[];
  /**
   * Joint effects beyond geometry: auto fits the terms that predict rows best which were not fitted, all looks among more of them; groups
   * of terms with their sizes in radians or metres, sag, tilt, ratio, harmonics, wobble, backlash, factors, payload, shift, runout
   * [default: auto]
   */
  corrections?: Value | readonly Value[];
  /** Highest order of the harmonics of a turn among these terms, 1 to 8 [default: 2] */
  harmonics?: Value | readonly Value[];
  /**
   * Further columns of the measurements on which terms may depend, like temperature; approach or approach_JOINT says from which side joints
   * came, 1 or -1, and payload which mass hangs at the tip, in kg
   */
  factors?: Value | readonly Value[];
  /**
   * Direction of gravity in the robot's base frame, like 0,0,1 for a robot on the ceiling; find takes the direction with which the terms
   * leave the least noise [default: 0,0,-1]
   */
  gravity?: Value | readonly Value[];
  /** Blocks to hold as in the model: joints, targets, frames, or names like joint2.axis, in which * stands for any letters */
  fix?: Value | readonly Value[];
  /**
   * Blocks to fit, also those that are usually held, like joint2.offset, and after --fix: `--fix joints --free joint2`. A target that is
   * named may be anywhere, not only near the tip: `--free targets`
   */
  free?: Value | readonly Value[];
  /**
   * Put the tip where the measured point is, for a model that ends in its reflector. Otherwise the links beyond the last joint stay as in
   * the model, and the point is the target `measured`
   */
  moveTip?: boolean;
  /** Treatment of outliers: auto fits by least squares, and by the tukey loss where that shows outliers */
  robust?: "auto" | "off" | "huber" | "cauchy" | "tukey";
  /**
   * Treatment of a device, a target, a nest or a joint's zero that moved during the session, and of configurations that are wrong as a
   * whole
   */
  repair?: "auto" | "off";
  /**
   * Largest repair of a device (usually 50 mm), a tool (20 mm) or a zero (5 deg), with its turn as an arc at a third of the robot's reach;
   * what is larger is named
   */
  repairLimit?: Value | readonly Value[];
  /**
   * Share of the configurations held out at random, unless a column `set`, --train-where or --validate chooses them; 0 fits every row
   * [default: 0.3; 0 if fewer than 12 would be held out, but for pictures, rows in motion and --accept]
   */
  heldOut?: Value | readonly Value[];
  /** Seed of that choice [default: 1] */
  seed?: Value | readonly Value[];
  /** End with code 1 if the verdict is worse than this (results are written all the same); it also does if the verdict is `do not use` */
  require?: "good" | "inside_sampled_range" | "measured_configurations" | "located";
  /**
   * End with code 1 unless the result clearly predicts better than the nominal model anywhere inside the sampled range, with 95 %
   * confidence
   */
  requireGain?: boolean;
  /**
   * Limits that the errors of rows that were not fitted must meet, like 0.2mm or 0.2mm,max:0.5mm,0.05deg: rms (the default), p95 or max of
   * all errors in a unit. End with code 1 unless each is shown to be kept, with 95 % confidence
   */
  accept?: Value | readonly Value[];
  /** Which model must meet them: the corrected one, if there is one (the default), or the calibrated one, which a URDF holds */
  acceptModel?: "corrected" | "calibrated";
  /** File for the report, or `none` [default: report.html among the results] */
  report?: Value | readonly Value[];
  /**
   * Entries of the report on the session, like serial=4711 (repeatable): certificate, laboratory, customer, robot, serial, instrument,
   * instrument_calibrated, tool, payload, speed, warm_up, operator, date, place, temperature, valid_until or note
   */
  record?: Value | readonly Value[];
}

/** Options of `poecal validate`, by their long names. */
export interface ValidateOptions {
  /** Most that a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names) */
  limit?: Value | readonly Value[];
  /** Wait so long, like 60s, for another run that writes to the same folder or ledger [default: refuse at once] */
  wait?: Value | readonly Value[];
  /** Units of columns that state none, like mm,deg; a mapping file takes precedence */
  units?: Value | readonly Value[];
  /** Refuse lost beams (empty or zero positions) instead of skipping them with a warning */
  strict?: boolean;
  /** Which rows share a frame of the measuring device: per-file if it was moved between the files */
  deviceFrames?: "common" | "per-file";
  /**
   * Match of rows of a joint file with rows of a measurement file [default: by name, else recordings by the times at which the robot stood
   * still and lists by their order, if the nominal model fits no other match as well]
   */
  join?: "name" | "rows" | "time" | "motion";
  /** Clock offset of two recordings, the measurements' time less that of the joint readings, where several fit [default: found] */
  lag?: Value | readonly Value[];
  /** Sheet of workbooks [default: the only one that holds a table] */
  sheet?: Value | readonly Value[];
  /** Body, marker or tool of recordings of a camera system [default: the only one that moves] */
  body?: Value | readonly Value[];
  /**
   * Topic of ROS 2 bags that has the joint readings or the measurements, where several can be meant; may be given again [default: the only
   * one]
   */
  topic?: Value | readonly Value[];
  /** Known distance between the two sockets of each place, like 50mm, or of pairs by name, like A-B=50mm,B-C=70mm+-0.02mm */
  socketDistance?: Value | readonly Value[];
  /** Kind of contact for rows whose `contact` cell is empty: touched by a point, or by a face that lies flush */
  contact?: "point" | "flush";
  /**
   * Noise of an instrument that grows with the distance, like tracker:10um+5um/m: a standard deviation in all directions, and one across
   * the line of sight for each metre; of all instruments without a name. For rows that state none; may be given again
   */
  instrumentNoise?: Value | readonly Value[];
  /**
   * Cameras of corners in pixels: CSV with name, fx, fy, cx, cy, k1 and so on in OpenCV's order (FILE#VERSION where it has several), YAML,
   * JSON or XML of OpenCV, ROS, Kalibr, ViSP, mrcal and makers of cameras, .dat of HALCON, a calibration.json with what it found, or
   * unknown:1920x1080 with the size of the pictures, for a lens that is found from them; may be given again
   */
  camera?: Value | readonly Value[];
  /**
   * Board or solid that cameras see: CSV with target, x[mm], y[mm], z[mm] of its points, chessboard:10x7:27mm (squares along x and y, and
   * their side), charuco:, circles:, aprilgrid: or tags: as poecal detect has them, YAML of Kalibr or industrial_calibration, settings of
   * OpenCV (YAML, XML), or a calibration.json with what it found; may be given again
   */
  markers?: Value | readonly Value[];
  /**
   * Refit to these measurements: the frame of the measuring device, the targets on the tool, or both; auto refits the device where the rows
   * show that it stands elsewhere, which is stated otherwise
   */
  refit?: "device" | "tool" | "auto";
  /**
   * End with code 1 unless the measurements confirm this: `good` if 80 % of all errors are inside their own 95 % bounds and the error (RMS)
   * is at most twice the expected one; `inside_sampled_range` if that holds of the rows inside the sampled range
   */
  require?: "good" | "inside_sampled_range" | "measured_configurations" | "located";
  /**
   * End with code 1 unless the calibration clearly predicts these measurements better than the nominal model, device frame and targets
   * fitted for both, with 95 % confidence
   */
  requireGain?: boolean;
  /**
   * Limits that the errors must meet, like 0.2mm or 0.2mm,max:0.5mm,0.05deg: rms (the default), p95 or max of all errors in a unit. End
   * with code 1 unless each is shown to be kept, with 95 % confidence
   */
  accept?: Value | readonly Value[];
  /** Which model must meet them: the corrected one, if there is one (the default), or the calibrated one, which a URDF holds */
  acceptModel?: "corrected" | "calibrated";
  /** File for the report, or `none` [default: report.html among the results] */
  report?: Value | readonly Value[];
  /** Entries of the report on this session, like operator=Mia (repeatable): the keys of `poecal calibrate` */
  record?: Value | readonly Value[];
  /** File to which the check is appended as a line, or `none` [default: history.jsonl beside the calibration] */
  history?: Value | readonly Value[];
}

/** Options of `poecal predict`, by their long names. */
export interface PredictOptions {
  /** Most that a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names) */
  limit?: Value | readonly Value[];
  /** Wait so long, like 60s, for another run that writes to the same folder or ledger [default: refuse at once] */
  wait?: Value | readonly Value[];
  /** First link of the chain, where a URDF has several */
  baseLink?: Value | readonly Value[];
  /** Last link of the chain, where a URDF has several */
  tipLink?: Value | readonly Value[];
  /** Units of columns that state none, like mm,deg; a mapping file takes precedence */
  units?: Value | readonly Value[];
  /** The frame of the poses */
  outputFrame?: "base" | "device";
  /**
   * Add the expected error of each prediction, and whether it lies in the sampled range (of a calibration.json); without --target of the
   * first target that was measured
   */
  withUncertainty?: boolean;
  /** Which model of a calibration predicts: the corrected one, if there is one, or the calibrated one, which a URDF holds */
  model?: "corrected" | "calibrated";
  /** Predict this target of the model, or the `tip` [default: the tip, but for --with-uncertainty]; of a URDF, with its link */
  target?: Value | readonly Value[];
}

/** Options of `poecal check`, by their long names. */
export interface CheckOptions {
  /** Most that a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names) */
  limit?: Value | readonly Value[];
  /** Wait so long, like 60s, for another run that writes to the same folder or ledger [default: refuse at once] */
  wait?: Value | readonly Value[];
  /** First link of the chain, where a URDF has several */
  baseLink?: Value | readonly Value[];
  /** Last link of the chain, where a URDF has several */
  tipLink?: Value | readonly Value[];
  /**
   * Instrument on the robot, as rows name it, and its link in a URDF (repeatable). The robot is then the tree of all joints between the
   * base and the named links
   */
  instrument?: Value | readonly Value[];
  /** Target, as rows name it, and its link in a URDF (repeatable), likewise. Without --tip-link, the first that a joint moves is the tip */
  target?: Value | readonly Value[];
  /** Units of columns that state none, like mm,deg; a mapping file takes precedence */
  units?: Value | readonly Value[];
  /** Refuse lost beams (empty or zero positions) instead of skipping them with a warning */
  strict?: boolean;
  /** Which rows share a frame of the measuring device: per-file if it was moved between the files */
  deviceFrames?: "common" | "per-file";
  /**
   * Match of rows of a joint file with rows of a measurement file [default: by name, else recordings by the times at which the robot stood
   * still and lists by their order, if the nominal model fits no other match as well]
   */
  join?: "name" | "rows" | "time" | "motion";
  /** Clock offset of two recordings, the measurements' time less that of the joint readings, where several fit [default: found] */
  lag?: Value | readonly Value[];
  /** Sheet of workbooks [default: the only one that holds a table] */
  sheet?: Value | readonly Value[];
  /** Body, marker or tool of recordings of a camera system [default: the only one that moves] */
  body?: Value | readonly Value[];
  /**
   * Topic of ROS 2 bags that has the joint readings or the measurements, where several can be meant; may be given again [default: the only
   * one]
   */
  topic?: Value | readonly Value[];
  /** Known distance between the two sockets of each place, like 50mm, or of pairs by name, like A-B=50mm,B-C=70mm+-0.02mm */
  socketDistance?: Value | readonly Value[];
  /** Kind of contact for rows whose `contact` cell is empty: touched by a point, or by a face that lies flush */
  contact?: "point" | "flush";
  /**
   * Noise of an instrument that grows with the distance, like tracker:10um+5um/m: a standard deviation in all directions, and one across
   * the line of sight for each metre; of all instruments without a name. For rows that state none; may be given again
   */
  instrumentNoise?: Value | readonly Value[];
  /**
   * Cameras of corners in pixels: CSV with name, fx, fy, cx, cy, k1 and so on in OpenCV's order (FILE#VERSION where it has several), YAML,
   * JSON or XML of OpenCV, ROS, Kalibr, ViSP, mrcal and makers of cameras, .dat of HALCON, a calibration.json with what it found, or
   * unknown:1920x1080 with the size of the pictures, for a lens that is found from them; may be given again
   */
  camera?: Value | readonly Value[];
  /**
   * Board or solid that cameras see: CSV with target, x[mm], y[mm], z[mm] of its points, chessboard:10x7:27mm (squares along x and y, and
   * their side), charuco:, circles:, aprilgrid: or tags: as poecal detect has them, YAML of Kalibr or industrial_calibration, settings of
   * OpenCV (YAML, XML), or a calibration.json with what it found; may be given again
   */
  markers?: Value | readonly Value[];
  /** Fit only rows whose COLUMN has one of these values, and hold out all others */
  trainWhere?: Value | readonly Value[];
  /** The measuring device's frame: `base` looks for mistakes in it too */
  deviceFrame?: "unknown" | "base";
}

/** Options of `poecal plan`, by their long names. */
export interface PlanOptions {
  /** Most that a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names) */
  limit?: Value | readonly Value[];
  /** Wait so long, like 60s, for another run that writes to the same folder or ledger [default: refuse at once] */
  wait?: Value | readonly Value[];
  /** First link of the chain, where a URDF has several */
  baseLink?: Value | readonly Value[];
  /** Last link of the chain, where a URDF has several */
  tipLink?: Value | readonly Value[];
  /**
   * Instrument on the robot, as rows name it, and its link in a URDF (repeatable). The robot is then the tree of all joints between the
   * base and the named links
   */
  instrument?: Value | readonly Value[];
  /** Target, as rows name it, and its link in a URDF (repeatable), likewise. Without --tip-link, the first that a joint moves is the tip */
  target?: Value | readonly Value[];
  /** Units of columns that state none, like mm,deg; a mapping file takes precedence */
  units?: Value | readonly Value[];
  /**
   * Cameras of corners in pixels: CSV with name, fx, fy, cx, cy, k1 and so on in OpenCV's order (FILE#VERSION where it has several), YAML,
   * JSON or XML of OpenCV, ROS, Kalibr, ViSP, mrcal and makers of cameras, .dat of HALCON, a calibration.json with what it found, or
   * unknown:1920x1080 with the size of the pictures, for a lens that is found from them; may be given again
   */
  camera?: Value | readonly Value[];
  /**
   * Board or solid that cameras see: CSV with target, x[mm], y[mm], z[mm] of its points, chessboard:10x7:27mm (squares along x and y, and
   * their side), charuco:, circles:, aprilgrid: or tags: as poecal detect has them, YAML of Kalibr or industrial_calibration, settings of
   * OpenCV (YAML, XML), or a calibration.json with what it found; may be given again
   */
  markers?: Value | readonly Value[];
  /**
   * Plan for something else than a calibration: drift chooses, of the configurations that a calibration.json was made of, those whose
   * repeats show the smallest shift of the worst joint, and prints what each joint would show; with --candidates among new ones. iso9283
   * lists P1 to P5 of the largest cube within reach and limits, or of the cube or plane (one side of zero) of --workspace, in --count
   * cycles, as a table to fill in [possible values: drift, iso9283]
   */
  purpose?: Value | readonly Value[];
  /** Standard deviation of one visit and coordinate, like 0.03mm, as measured by repeats [default: the noise of the calibration] */
  repeatability?: Value | readonly Value[];
  /** State of the tool with its targets at the visits: same if it stays on the flange [default: same] */
  tool?: "same" | "refit";
  /** Rows of an earlier visit whose configurations may be repeated [default: the measurements that the calibration was made of] */
  reference?: Value | readonly Value[];
  /** Quantity that will be measured of the tip */
  kind?: "pose" | "mixed" | "relative" | "point" | "component" | "distance" | "ball-bar" | "distance-change" | "sphere" | "socket" | "plane" | "height" | "flush" | "direction";
  /** Number of different configurations to fit [with --purpose drift: to measure at each visit, by default 8] [default: 30] */
  count?: Value | readonly Value[];
  /** Number of further rows to judge by, at random over the workspace [default: a third of the configurations] */
  heldOutCount?: Value | readonly Value[];
  /** Choose from these configurations alone (a table of joint readings) */
  candidates?: Value | readonly Value[];
  /**
   * Workspace in which predictions shall be good: anywhere within its limits, in the configurations of a file, or with the tip in a box of
   * the base frame, from one corner to the other [default: limits]
   */
  workspace?: Value | readonly Value[];
  /**
   * Rows that are in the list in any case, or were measured already (a table of joint readings): new ones complete them, and --count counts
   * both. Rows whose `set` is held_out do not count
   */
  keepRows?: Value | readonly Value[];
  /**
   * Rows of --keep-rows, counted from 1 through all files, that collided or were not seen: new ones take their places, not within 10
   * degrees of them, and all other rows stay. The list has all rows then, in their order
   */
  replaceRows?: Value | readonly Value[];
  /** Purpose of the list */
  criterion?: "expected" | "D" | "A" | "E" | "G";
  /** Number of targets of a nest at the tip, all measured in each configuration [default: 1] */
  targets?: Value | readonly Value[];
  /**
   * Position of the target in the tip's frame, of several the first, the others turned about z, like 50,0,30mm [default: the targets of the
   * model, or the tip]
   */
  targetOffset?: Value | readonly Value[];
  /** Standard deviation of each measured position component [default: 0.05mm] */
  sigmaPosition?: Value | readonly Value[];
  /** Standard deviation of each measured rotation component [default: 0.01deg] */
  sigmaRotation?: Value | readonly Value[];
  /**
   * Error of the tip (RMS) that a calibration leaves however much is measured, and that with corrections, like 0.3mm or 0.3mm,0.12mm, as an
   * earlier calibration of such a robot found it [default: 0.3 mm for each metre of reach, which is an assumption]
   */
  robotError?: Value | readonly Value[];
  /** The measuring device's frame */
  deviceFrame?: "unknown" | "base";
  /**
   * Deviations of the axes from the model (the prior of the fit): standard deviations of their directions and places, or none [default:
   * 0.5deg,5mm]
   */
  tolerance?: Value | readonly Value[];
  /**
   * Joint effects that are expected beyond geometry: auto and all terms of the common sizes, off nothing, or groups with their sizes, as of
   * poecal calibrate [default: auto]
   */
  corrections?: Value | readonly Value[];
  /** Direction of gravity in the robot's base frame [default: 0,0,-1] */
  gravity?: Value | readonly Value[];
  /** Distance of every joint from its limits [default: 2deg,5mm; of a list that is stated none] */
  margin?: Value | readonly Value[];
  /** Box into which no part of the robot may reach, by two corners (repeatable) */
  keepOut?: Value | readonly Value[];
  /** Height above which all links that move stay, like 20mm */
  floorHeight?: Value | readonly Value[];
  /** Least change of some joint between any two configurations */
  separation?: Value | readonly Value[];
  /**
   * Position of the measuring device; targets that links hide from it are left out. With --purpose drift: known where it will stand as it
   * stood, as on fixed nests, or refit
   */
  device?: Value | readonly Value[];
  /** Half the angle of the device's cone, about the direction from it to --device-aim */
  deviceHalfAngle?: Value | readonly Value[];
  /** Point at which the device is aimed [default: the base] */
  deviceAim?: Value | readonly Value[];
  /** Least and largest distance of the target from the device, like 0.5m:10m */
  distance?: Value | readonly Value[];
  /** Largest angle between the direction in which the target looks and the line to the device: of a reflector or a board */
  targetHalfAngle?: Value | readonly Value[];
  /** The direction in which the target looks, in its own frame [default: 0,0,1] */
  targetNormal?: Value | readonly Value[];
  /** Check of links that overlap by their shapes in the URDF: capsules around these, so that a little room is lost */
  selfCollision?: "avoid" | "ignore";
  /** Dwell at each row, for the duration of the whole [default: 30s] */
  stop?: Value | readonly Value[];
  /** Seed of everything random [default: 1] */
  seed?: Value | readonly Value[];
  /**
   * Write the list also as a program of joint motions with a stop at each row: its name ends in .script (Universal Robots), .mod (ABB),
   * .src (KUKA) or .ls (FANUC)
   */
  program?: Value | readonly Value[];
  /** Write a page of the plan (HTML): the targets of all configurations, some arms, the device, errors by number, how each joint is sampled */
  report?: Value | readonly Value[];
}

/** Options of `poecal export`, by their long names. */
export interface ExportOptions {
  /** Most that a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names) */
  limit?: Value | readonly Value[];
  /** Wait so long, like 60s, for another run that writes to the same folder or ledger [default: refuse at once] */
  wait?: Value | readonly Value[];
  /** First link of the chain, where a URDF has several */
  baseLink?: Value | readonly Value[];
  /** Last link of the chain, where a URDF has several */
  tipLink?: Value | readonly Value[];
  /**
   * Instrument on the robot, as rows name it, and its link in a URDF (repeatable). The robot is then the tree of all joints between the
   * base and the named links
   */
  instrument?: Value | readonly Value[];
  /** Target, as rows name it, and its link in a URDF (repeatable), likewise. Without --tip-link, the first that a joint moves is the tip */
  target?: Value | readonly Value[];
  /** Which model of the calibration: geometry alone, or the corrected one, whose terms of the joints go to a file beside, FILE.joints.json */
  model?: "corrected" | "calibrated";
  /**
   * Write the screws and home pose of the robot with this added to the joint's value, like joint2=0.5deg or slide=1.2mm (repeatable). Mimic
   * joints that follow it stay: an error of its encoder would move them too
   */
  offset?: Value | readonly Value[];
  /** The controller's checksum, which the driver compares, like calib_12788084448423163542; for --format ur */
  hash?: Value | readonly Value[];
}

/** Options of `poecal simulate`, by their long names. */
export interface SimulateOptions {
  /** Most that a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names) */
  limit?: Value | readonly Value[];
  /** Wait so long, like 60s, for another run that writes to the same folder or ledger [default: refuse at once] */
  wait?: Value | readonly Value[];
  /** First link of the chain, where a URDF has several */
  baseLink?: Value | readonly Value[];
  /** Last link of the chain, where a URDF has several */
  tipLink?: Value | readonly Value[];
  /**
   * Instrument on the robot, as rows name it, and its link in a URDF (repeatable). The robot is then the tree of all joints between the
   * base and the named links
   */
  instrument?: Value | readonly Value[];
  /** Target, as rows name it, and its link in a URDF (repeatable), likewise. Without --tip-link, the first that a joint moves is the tip */
  target?: Value | readonly Value[];
  /** Angle and distance by which every axis, and the tip, is off [default: 1deg,2mm] */
  errors?: Value | readonly Value[];
  /** Standard deviations of each measured component; with --camera, of what the arm is off in each configuration [default: 0.05mm,0.01deg] */
  noise?: Value | readonly Value[];
  /**
   * Joint effects beyond geometry: groups of terms with the standard deviations of their random coefficients in radians or metres, sag,
   * tilt, ratio, harmonics, wobble, backlash, factors, payload, shift, runout [default: off]
   */
  terms?: Value | readonly Value[];
  /** Direction of gravity in the robot's base frame [default: 0,0,-1] */
  gravity?: Value | readonly Value[];
  /** Number of measurements [default: 50] */
  count?: Value | readonly Value[];
  /** Seed of everything random [default: 1] */
  seed?: Value | readonly Value[];
  /** Kind of the measurements */
  kind?: "pose" | "mixed" | "relative" | "point" | "component" | "distance" | "ball-bar" | "distance-change" | "sphere" | "socket" | "plane" | "height" | "flush" | "direction";
  /** The measuring device's frame: unknown, or the robot's base */
  deviceFrame?: "unknown" | "base";
  /** Number of further measurements, free of noise, to judge a calibration by [default: 0] */
  heldOutCount?: Value | readonly Value[];
  /** Pictures of a board and the readings of each, in place of measurements: where the camera is */
  camera?: "in-hand" | "beside";
  /** The board in the pictures, as poecal detect --print draws it [default: charuco:7x5:36mm:26mm:DICT_4X4_50] */
  board?: Value | readonly Value[];
}

/** A finished calibration. */
export type CalibrationFile = {
  /** Result of the requested acceptance limits; absent if none were requested. */
  acceptance?: Acceptance | null;
  /** Errors of the nominal, registered and calibrated model on training and held-out rows. */
  accuracy: Accuracy;
  /** Fitted and held blocks, if they differ from the default: all axes, targets and frames. */
  blocks?: BlocksEntry | null;
  /** Clocks of instruments that measured in motion; absent where none did. */
  clocks?: ClockEntry[];
  /** Directions in which the measurements determine corrections of several joints only together; absent if there are none. */
  common?: CommonDirectionEntry[];
  /**
   * Error of programs for the nominal robot in the sampled workspace, and the joint corrections that remove it. Absent if the calibration
   * is not to be used, or if some joint does not move the robot's tip.
   */
  compensation?: CompensationEntry | null;
  /** Mapping from the controller's counts to the readings of the joints; absent if they are equal. */
  controller?: Controller | null;
  /** The corrected model: screws and terms of the joints fitted together; absent if no terms were requested. */
  corrected?: CorrectedEntry | null;
  /** Each joint's correction. */
  corrections?: CorrectionEntry[];
  /** Sampled part of each joint's range. */
  coverage?: JointCoverage[];
  /** Cross-validation: errors of rows that are predicted by a fit of the others; null if there are too few. */
  cross_validation?: CrossValidationEntry | null;
  /** Mistakes in the input: reported, not corrected. */
  diagnosis?: DiagnosisEntry[];
  /** Determination of the unknowns by the measurements. */
  identifiability: IdentifiabilityEntry;
  /** Inputs. */
  inputs: Inputs;
  /** Instruments on the robot. */
  instruments?: { [name: string]: InstrumentEntry };
  /** The calibrated joints from base to tip. */
  joints: JointEntry[];
  /** Frame of the measuring device. */
  measurement_frame: FrameEntry;
  /** True if the measured point became the tip (`--move-tip`); otherwise the tip is the model's, on the last link. */
  move_tip?: boolean;
  /** Noise by which residuals were weighted. */
  noise: NoiseEntry;
  /** Suspected rows, the worst first, at most 1,000; `robust` has their number. */
  outliers?: OutlierEntry[];
  /** The pictures, their noise and lenses; absent if there are none. */
  pictures?: PicturesEntry | null;
  /** Version of the program. */
  poecal_version: string;
  /** Joints that were recalibrated since, by `poecal track --recalibrate`, in order; everything else is of the earlier calibration. */
  recalibrated?: RecalibratedEntry[];
  /** Statements about the session; absent if there are none. */
  record?: Record;
  /** Events of the session that were repaired; everything else in this file is of the repaired session. */
  repairs?: Event[];
  /** Configurations that were measured several times; null if there are none. */
  repeatability?: RepeatabilityEntry | null;
  /** The calibrated robot's frames. */
  robot: RobotEntry;
  /** Treatment of outliers. */
  robust?: RobustEntry;
  /** Version of the file. */
  schema: string;
  /** The minimisation: steps, end, convergence. */
  solver: SolverEntry;
  /** Stations of the measuring device, if they are named or several; the first is that of `measurement_frame`. */
  stations?: StationEntry[];
  /**
   * Configurations in which all targets are suspected with similar residuals, the worst first, at most 100: the arm or its readings are
   * wrong there.
   */
  suspected_configurations?: SuspectedConfigurationEntry[];
  /** Probable events that were not repaired. */
  suspicions?: Event[];
  /**
   * Targets by their names, `measured` if no row names one: in the tip frame, or on a body of their own (`on`). Empty if `move_tip` is
   * true.
   */
  targets: { [name: string]: TargetEntry };
  /** Pose of the tip in the last joint's frame. */
  tool: PoseEntry;
  /** Expected errors of predictions; null without more residuals than unknowns. */
  uncertainty?: UncertaintyEntry | null;
  /** Verdict: fitness of the result for use, and its domain. */
  verdict?: Verdict | null;
  /** Warnings, a sentence each. */
  warnings?: string[];
};

/** Decision whether a calibration keeps the requested limits. */
export type Acceptance = {
  /** Rows that decided. */
  by: AcceptedRows;
  /** The worst decision of all limits. */
  decision: Decision;
  /** Each limit, by quantity. */
  limits: AcceptedLimit[];
  /** Judged model. */
  model: AcceptedModel;
};

/** Limit, observed figure and decision. Numbers are in millimetres or degrees. */
export type AcceptedLimit = {
  /** Number of different configurations among them; these count as independent. */
  configurations: number;
  /** Decision by these bounds. */
  decision: Decision;
  /** Figure observed on the rows. */
  found: number;
  /** Lower bound, with 95 % confidence. */
  from: number;
  /** The limit. */
  limit: number;
  /** The measured quantity: `position`, `rotation` and so on. */
  quantity: string;
  /** Number of rows that measured the quantity. */
  rows: number;
  /** Limited statistic of the errors. */
  statistic: AcceptedStatistic;
  /** Upper bound, with 95 % confidence; null if the rows are too few for one. */
  to?: number | null;
  /** Unit of the numbers: `mm` or `deg`. */
  unit: string;
};

/** Which model is judged. */
export type AcceptedModel = "corrected" | "calibrated";

/** Rows that decided. */
export type AcceptedRows = "held_out" | "cross_validation" | "judged";

/** Statistic of the errors that is limited. */
export type AcceptedStatistic = "rms" | "p95" | "max";

/** Errors on training and held-out rows. */
export type Accuracy = {
  /** Number of configurations, if all were fitted because too few would have been held out; absent otherwise. */
  few_configurations?: number | null;
  /** On the held-out rows; null if there are none. */
  held_out?: SetAccuracy | null;
  /** On the training rows. */
  training: SetAccuracy;
};

/** Source of the residuals: robot or instrument. */
export type Attribution = "robot" | "stated_noise" | "repeats";

/** Tilt and shift of an axis. */
export type AxisEntry = {
  /** Shift of its position, millimetres; null for a joint that slides. */
  shift_mm?: number | null;
  /** Tilt of its direction, degrees. */
  tilt_deg?: number | null;
};

/** Blocks of unknowns by name: `JOINT.axis`, `JOINT.offset` and other terms, `target.NAME`, `frame.NAME`. */
export type BlocksEntry = {
  /** Fitted. */
  free: string[];
  /** Held as in the model; terms that are zero are not listed. */
  held: string[];
};

/** A body of known points. */
export type BoardEntry = {
  /** Name. */
  name: string;
  /** Points. */
  points: PointEntry[];
};

/** A body of the robot: `"base"`, or `{"link_of": "joint2"}`, the link that this joint moves. */
export type BodyEntry = "base" | {
  link_of: string;
};

/** Spread of predictions at measured configurations over bootstrap samples of the rows. */
export type BootstrapEntry = {
  /** Number of samples: neighbourhoods of rows, with replacement. */
  drawings: number;
  /** Root mean square distance by the covariance, for white noise, millimetres. */
  formal_sigma_position_mm: number;
  /** Root mean square distance over these samples, millimetres. */
  sigma_position_mm: number;
};

/** A camera with its lens. */
export type CameraEntry = {
  /** Intersection of the axis with the picture, pixels; the centre of the first pixel is (0, 0). */
  centre_px: [number, number];
  /** Coefficients of the distortion. */
  distortion: number[];
  /** Focal lengths along u and v, pixels. */
  focal_px: [number, number];
  /** `brown` with k1, k2, p1, p2, k3, k4, k5, k6 in OpenCV's order, or `fisheye` with k1 to k4. */
  model: string;
  /** Name. */
  name: string;
  /** Width and height, pixels; null if they are not known. */
  size_px?: [number, number] | null;
};

/** Cause of an undetermined direction. The words appear in `calibration.json` and do not change. */
export type Cause = "own_axis" | "base_frame" | "joint_offsets" | "no_orientation" | "unseen" | "stood_still" | "too_few" | "point_on_axis" | "one_orientation" | "one_turning_direction" | "moved_together" | "small_motion" | "dependent_motion" | "no_length" | "seen_once" | "other";

/** Centre of the turn of the shared error of a picture's corners. */
export type Centre = "board" | "camera";

/**
 * The clock of an instrument whose rows were measured in motion, relative to that of the joint readings. A measurement at its time t
 * belongs to the readings at `t - lag - drift (t - middle)`.
 */
export type ClockEntry = {
  /** Growth of the lag, parts per million. */
  drift_ppm: number;
  /** Name of the instrument, if the measurements name it. */
  instrument?: string | null;
  /** Time of the instrument less that of the joint readings in the middle of the recording, seconds. */
  lag_s: number;
  /** The middle of the recording by the clock of the instrument, seconds. */
  middle_s: number;
  /** Its standard deviation; absent as for the lag. */
  sigma_drift_ppm?: number | null;
  /** Its standard deviation, milliseconds; absent where the lag was held, and without more residuals than unknowns. */
  sigma_lag_ms?: number | null;
};

/** A direction in which the measurements determine corrections of several joints only together. */
export type CommonDirectionEntry = {
  /** Root mean square change of predicted positions by one standard deviation, at the measured configurations, millimetres. */
  effect_mm: number;
  /** The joints. */
  joints: string[];
  /** Its share in the variance of all corrections, 0 to 1. */
  share: number;
  /** In words: one standard deviation of it, and its effect on predictions. */
  words: string;
};

/** The error that the corners of a picture share: standard deviations of each component. */
export type CommonEntry = {
  /** Point about which it turns. */
  about: Centre;
  /**
   * Ratio by which the corners move the pose of the board more than their own noise does, for a picture of another lens or board; 1 if
   * absent.
   */
  corners?: number;
  /** Shift, millimetres. */
  shift_mm: number;
  /** Turn, degrees. */
  turn_deg: number;
};

/**
 * Distance of the actual robot's tip from the nominal one over the sampled workspace, and the joint corrections that remove it. Tool and
 * base of the nominal robot are fitted to the actual one over every third configuration, as if both had been taught on it. The base is
 * fitted only if the device's frame was unknown. The remaining displacement is that of the joints. The actual robot is the corrected model,
 * if there is one.
 */
export type CompensationEntry = {
  /** Joint whose axis the map is about; null if that is the base's z axis. */
  about?: string | null;
  /** Number of configurations whose corrected readings are beyond a joint's limits. */
  beyond_limits: number;
  /** Side of the map's cells, metres. */
  cell_m: number;
  /** Parts of the workspace that contain configurations of the sample, by height and then by distance from the axis. */
  cells: WorkspaceCellEntry[];
  /** Number of configurations. */
  configurations: number;
  /** Corrections of each reading that moves the tip; empty for an arm with fewer than six, which cannot correct every displacement. */
  joints: ReadingChangeEntry[];
  /** Number of configurations from which no small correction leads to the pose, near a singularity: only another branch reaches it, or none. */
  not_correctable: number;
  /** Distances, millimetres. */
  position_mm: SpreadEntry;
  /** Angles, degrees. */
  rotation_deg: SpreadEntry;
  /** Number of configurations whose tip is displaced by no more than the expected error of the calibration: they need no correction. */
  within_expected_error: number;
};

/**
 * Relation of a controller's readings to those of the model, `reading = Σ factor · counted + offset`. An example is a third axis that
 * counts from the horizontal. It is kept in `calibration.json` if they are not equal one by one.
 */
export type Controller = {
  /** Readings of the model's joints, in their order. */
  readings: ControllerReading[];
  /** Reference of the third axis, if it was stated; absent otherwise. */
  third_axis?: ThirdAxisWord | null;
};

/** A column of the controller's readings. */
export type ControllerColumn = {
  /** Factor. */
  factor: number;
  /** Unit of its numbers in the measurement files. */
  unit: string;
};

/** Composition of a reading of the model. */
export type ControllerReading = {
  /** Columns of the measurement files that were summed; empty for a constant. */
  columns: { [name: string]: ControllerColumn };
  /** Offset, radians or metres. */
  offset?: number;
  /** Name. */
  reading: string;
};

/**
 * Screws and terms of the joints, fitted together. Its entries replace those of the same name where predictions are those of the corrected
 * model.
 */
export type CorrectedEntry = {
  /** Effect of each group of terms at each joint, the joint that moves the target most first. */
  effects?: EffectEntry[];
  /** Effects that the measurements cannot distinguish, a sentence each. */
  indistinguishable?: string[];
  /** Instruments on the robot. */
  instruments?: { [name: string]: InstrumentEntry };
  /** Error of each joint over its sampled range, before and after. */
  joint_errors?: JointErrorsEntry[];
  /** The joints from base to tip: those of the robot, each followed by its compliant joints. */
  joints: JointEntry[];
  /**
   * Error of positions in cross-validation, millimetres (RMS): that of geometry alone times the share that remains with terms. Absent if
   * the sizes were stated.
   */
  left_out_position_mm?: number | null;
  /** Frame of the measuring device. */
  measurement_frame: FrameEntry;
  /** Standard deviation of each component of the noise, millimetres or degrees, as estimated by the fit of screws and terms. */
  noise: MeasuredOfNumber;
  /** Reason for these sizes. */
  reason: SizesReason;
  /** The corrected robot's frames, and the weights that it carries. */
  robot: RobotEntry;
  /** Prior standard deviation of the terms of each group, radians, of shift and runout metres; 0 where cross-validation left a group out. */
  sizes: { [name: string]: number };
  /** Stations of the measuring device, if they are named or several. */
  stations?: StationEntry[];
  /** Named targets. */
  targets: { [name: string]: TargetEntry };
  /** Pose of the tip in the last joint's frame. */
  tool: PoseEntry;
  /** Sizes that cross-validation tried; empty if the sizes were stated. */
  tried?: TriedEntry[];
  /** Expected errors of predictions; null without more residuals than the measurements determine unknowns. */
  uncertainty?: UncertaintyEntry | null;
};

/** A joint's correction, its uncertainty, and its effect. */
export type CorrectionEntry = {
  /**
   * Difference of the axis from the nominal one, offsets of earlier joints included, unlike `change`: of its direction, and of its distance
   * from the nominal joint's origin.
   */
  axis: AxisEntry;
  /** The correction in parts, with directions; missing in older files. */
  change?: JointChangeEntry | null;
  /** The joint. */
  joint: string;
  /** Root mean square position error with this screw alone nominal, millimetres. */
  left_nominal_rms_mm: number;
  /** Share of the measurements in the information on the axis' position; absent for a joint that slides. */
  shift_from_data?: number | null;
  /** Standard deviations of `axis` (root mean square); null where it is not determined. */
  sigma: AxisEntry;
  /** `sigma` if the axes of all other joints were known; absent where the axis was held. */
  sigma_alone?: AxisEntry | null;
  /** Reason for suspicion of the joint: a correction beyond those of the others, or residuals that follow its position. */
  suspicious?: string | null;
  /** Share of the measurements in the information on the direction, from 0 to 1; the rest is the tolerance's. Absent without a tolerance. */
  tilt_from_data?: number | null;
};

/** A strong correlation of two unknowns. */
export type CorrelatedEntry = {
  /** Their correlation, -1 to 1. */
  correlation: number;
  /** The two unknowns. */
  unknowns: [string, string];
};

/** Correlations of the unknowns, by blocks. */
export type CorrelationsEntry = {
  /** The blocks, in the order of their unknowns. */
  blocks: string[];
  /** For each block and each up to it the largest size of a correlation between unknowns of the two, 0 to 1. */
  largest: number[][];
  /** The strongest of these, at most 20. */
  pairs: CorrelatedEntry[];
  /** Number of pairs with a correlation of 0.95 or more, of either sign. */
  strong: number;
};

/** Cross-validation on the fitted rows. */
export type CrossValidationEntry = {
  /** The ends of each joint's range, files, and groups of equal `id`, each predicted by a fit without it. */
  blocked: LeftOutEntry[];
  /** Errors of the rows with a joint beyond the range of the rows that predicted them, by more than a tenth of it. Absent if there are none. */
  outside?: LeftOutEntry | null;
  /** Random folds, all together. */
  random: LeftOutEntry;
};

/** Decision on a limit by measurements. */
export type Decision = "pass" | "not_shown" | "fail";

/** A mistake in the input. */
export type DiagnosisEntry = {
  /** Kind of the mistake. */
  kind: DiagnosisKind;
  /** Rows concerned, counted from 0 over all files; empty if all are. */
  rows: number[];
  /** Evidence and advice. */
  statement: string;
};

/** Kind of a mistake. The words do not change between versions. */
export type DiagnosisKind = "joint_unit" | "position_unit" | "joint_sign" | "joints_swapped" | "joints_coupled" | "joint_zero" | "quaternion_order" | "inverted_pose" | "euler_convention" | "left_handed" | "row_shift" | "targets_swapped" | "targets_unnamed" | "joint_scale" | "board_size" | "length_unit" | "distance_zero" | "known_length" | "height_sign" | "tilt_unit" | "places_swapped" | "duplicate_rows";

/** Unknowns that the measurements do not determine, or only weakly. */
export type Direction = {
  /** Cause. */
  cause?: Cause;
  /** Description. */
  description: string;
  /** Number of independent directions. */
  directions?: number;
  /** Joints concerned. */
  joints: string[];
};

/** Effect of one group of terms at one joint. */
export type EffectEntry = {
  /** Largest deviation in the fitted rows, milliradians, of shift and runout millimetres; of a ratio the change each radian. */
  amplitude: number;
  /** Share of its prior variance that the measurements removed, 0 to 1. */
  determined_share: number;
  /** Distance by which it moves the target in the fitted rows, but for the mean of all (root mean square), millimetres. */
  effect_mm: number;
  /** True if it is larger than chance and the prior explain. */
  found: boolean;
  /** The group. */
  group: string;
  /** The joint. */
  joint: string;
  /** Its standard deviation. */
  sigma: number;
  /** The effect in words. */
  words: string;
};

/** An event during a session. */
export type Event = {
  /** The same error after the repair; absent if none was tried. */
  error_after_mm?: number | null;
  /** Error of the delivered model in cross-validation (RMS, millimetres, or degrees without positions) before the repair. */
  error_before_mm?: number | null;
  /** File and line of this measurement. */
  from: string;
  /** Number of the first measurement after it, from 1; for wrong configurations the first of them. */
  from_row: number;
  /** Kind of the event. */
  kind: EventKind;
  /** Moved object: the instrument, the target, the joint; empty without a name. */
  name: string;
  /** Errors of some rows in their order, by the models before and after the repair, millimetres or degrees; empty without a repair. */
  residuals?: Array<[number, number, number]>;
  /** Numbers of the measurements of wrong configurations. */
  rows?: number[];
  /** Angle, degrees. */
  size_deg?: number | null;
  /** Distance, millimetres; for a drift from the first measurement to the last. */
  size_mm?: number | null;
  /** Interpretation in the repair, or advice, a sentence. */
  statement: string;
};

/** Kind of an event. The words do not change between versions. */
export type EventKind = "device" | "target" | "nest" | "zero" | "drift" | "rows";

/** Expected errors of predicted positions, millimetres. */
export type ExpectedEntry = {
  /** Mean of the 95 % bounds. */
  bound95_position_mm: number;
  /** Root mean square distance. */
  sigma_position_mm: number;
  /** The largest of these. */
  worst_bound95_position_mm: number;
};

/** Another reading of each configuration. */
export type FactorReading = {
  /** Name of its column. */
  name: string;
  /** Value at which its terms are zero. */
  reference: number;
};

/** An estimated number of a camera or of a board. */
export type FoundEntry = {
  /** Standard deviation of the estimate, by the corners and the prior. */
  deviation: number;
  /** Estimated value. */
  found: number;
  /** Initial value. */
  given: number;
  /** Name: `lens`, `board` or `markers`, then a name, and the number's own, such as `lens.left.fx`. */
  name: string;
  /** Standard deviation of the prior. */
  prior: number;
  /** Unit, `px` or `mm`; empty for shares and for coefficients. */
  unit: string;
};

/** Frame of the measuring device. */
export type FrameEntry = {
  /** Pose of the device in the base. */
  base_from_device: PoseEntry;
  /** Knowledge of the frame: unknown, or equal to the base. */
  known: FrameWord;
};

/** Knowledge of the device frame. */
export type FrameWord = "unknown" | "base";

/** Decision whether the delivered model predicts better than the nominal model: anywhere inside the sampled range, or on rows that judge it. */
export type Gain = "clear" | "unclear" | "loss";

/** Weights that a robot carries. Their masses are contained in the coefficients. */
export type GravityEntry = {
  /** Direction of gravity, base frame. */
  direction: [number, number, number];
  /**
   * Longest lever arm of each joint, the divisor of moments about it: the path from joint to joint to the farthest weight. It follows from
   * the other entries; 0 for a joint that carries nothing.
   */
  joint_levers_m?: number[];
  /**
   * Sum over the masses that a joint carries, each times its longest lever arm; for a joint that slides, the masses alone. It divides the
   * moment of all masses. It follows from the other entries; 0 for a joint that carries nothing.
   */
  joint_mass_levers_kg_m?: number[];
  /** Origin of each joint of the nominal model at zero joint values, the reference of its moments, base frame. */
  joint_origins_m: Array<[number, number, number]>;
  /** The weights; the term `sag1` is of the first. */
  weights: WeightEntry[];
};

/** Determination of the unknowns by the measurements. */
export type IdentifiabilityEntry = {
  /** Condition number over these directions; null if there are none. */
  condition?: number | null;
  /** Effective number of unknowns that the measurements determine beside the prior. */
  effective_unknowns?: number | null;
  /** Observability indices; null where a singular value is zero. */
  observability?: Observability;
  /** Unknowns in the minimal basis. */
  parameters: number;
  /** Directions that the data determine against the noise. */
  rank: number;
  /** Directions that are not observable by measurements of this kind: not among the parameters, and without effect on predictions. */
  structural?: Direction[];
  /** Directions that the configurations do not determine. */
  unidentifiable: Direction[];
  /** Directions that they determine weakly, little better than the nominal model. */
  weak?: Direction[];
};

/** A cell of an image: corners in pictures that are not suspected, fitted or held out. */
export type ImageCellEntry = {
  /** The same by the delivered model. */
  after_px?: number | null;
  /** Column and row, from 0. */
  at: [number, number];
  /** Their root mean square distance from their pixels by the registered model; null without corners. */
  before_px?: number | null;
  /** Number of corners. */
  corners: number;
  /** Mean of measured minus predicted pixel by that model, along u and v. */
  mean_px?: [number, number] | null;
  /**
   * Root mean square uncertainty of the predicted pixel of a point before the middle of the cell, by the covariance of robot, camera and
   * board; null beyond the lens.
   */
  predicted_px?: number | null;
};

/** Errors of corners over the image of a camera, and the uncertainty of predicted pixels there. */
export type ImageEntry = {
  /** The camera. */
  camera: string;
  /** Side of the square cells, pixels; the first begins at the corner of the first pixel. */
  cell_px: number;
  /** The cells, row by row. */
  cells: ImageCellEntry[];
  /** Depth of the points whose prediction is judged, millimetres: the median of the boards'. */
  distance_mm: number;
};

/** Ratio of the root mean square error of the nominal model, registered, to that of another model on the same rows. */
export type Improvement = {
  /** The factor. */
  factor: number;
  /** Lower end of its interval, with 95 % confidence. */
  from: number;
  /** Upper end. */
  to: number;
};

/** Improvement of each quantity by the models that are fitted. */
export type Improvements = {
  /** Improvement by the calibrated model. */
  calibrated: MeasuredOfImprovement;
  /** Improvement by the corrected model; absent if there is none. */
  corrected?: MeasuredOfImprovement | null;
};

/** A file that was read. */
export type InputEntry = {
  /** Its name, as in `measurements`. */
  file: string;
  /** Form of the file; absent for a table in our form. */
  form?: string | null;
  /** Number of beam breaks: measurements without a position, which were left out. */
  lost?: number;
  /** Number of rows of the file, including beam breaks. */
  rows: number;
  /** Number of items that were taken, by quantity: `joint readings`, `points`, `poses` and other measurements. */
  taken: { [name: string]: number };
  /** Interpretation of a file in another form, in a few words: sheet, frame, body, topic, unit. */
  understood?: string | null;
  /** Units of its columns. */
  units?: string[];
};

/** Inputs. */
export type Inputs = {
  /** The command that reproduces the calibration; null if it was not made by the program. */
  command?: string | null;
  /** Kind of each measurement file and its used rows; one with joint readings and measurements has two entries. */
  files?: InputEntry[];
  /** Joins of files of joint readings with files of measurements; absent if one file has both. */
  joins?: JoinEntry[];
  /** The measurement files, as named by the user. */
  measurements: string[];
  /** The robot model, as named by the user. */
  model: string;
  /** SHA-256 of each file by its name; of input that is no regular file, such as a pipe, only for measurements. */
  sha256?: { [name: string]: string };
  /** The URDF that was calibrated; absent if the model was no URDF. */
  urdf?: OriginalUrdf | null;
};

/** An instrument on the robot. */
export type InstrumentEntry = {
  /** Body that carries it. Its pose is in the frame of the joint that moves the body, or in the base. */
  on: BodyEntry;
  /** Position, metres. */
  position_m: [number, number, number];
  /** Unit quaternion x, y, z, w. */
  quaternion_xyzw: [number, number, number, number];
};

/** Method by which the rows of a file of joint readings and of one of measurements are matched. */
export type Join = "name" | "rows" | "time" | "motion";

/** Join of a file of measurements with one of joint readings. */
export type JoinEntry = {
  /** Method by which rows were matched. */
  join: Join;
  /** Number of rows of joint readings, or of static intervals of their stream. */
  joint_rows: number;
  /** The file of joint readings. */
  joints: string;
  /** Time of the measurements less that of the joint readings, seconds; absent without clocks. */
  lag_s?: number | null;
  /** The target's motion, for a stream of measurements, or for single points with times. */
  measured_motion?: MotionEntry | null;
  /** Number of measured configurations, or of static intervals of the stream of measurements. */
  measured_rows: number;
  /** The file of measurements. */
  measurements: string;
  /** Median error of the nominal robot at the pairs, millimetres; absent if there are too few pairs. */
  missed_mm?: number | null;
  /** Number of pairs. */
  paired: number;
  /** Pairs: number of the row of joint readings, and of the measured configuration, each from 1; at most 2,000. */
  pairs: Array<[number, number]>;
  /** Joint readings with more than one measurement. */
  repeated?: RowEntry[];
  /** The robot's motion, for a stream of joint readings. */
  robot_motion?: MotionEntry | null;
  /** Joint readings without a measurement; at most 1,000, as in the next two lists. */
  unmeasured?: RowEntry[];
  /** Measured configurations that were left out, because they have no joint readings. */
  unread?: RowEntry[];
};

/**
 * Difference of a joint from the nominal one, in parts: a joint offset, and the tilt and shift of the axis that offsets and base do not
 * explain. Directions are those of the base frame with all joints at zero.
 */
export type JointChangeEntry = {
  /** The point of the axis for which the shift is stated: the nearest to the joint's origin, metres. */
  at_m: [number, number, number];
  /** Addition to the value of a joint that turns, degrees; null where base or tool can take its place. */
  offset_deg?: number | null;
  /** Addition to the value of a joint that slides, millimetres. */
  offset_mm?: number | null;
  /** Shift of the axis across itself, millimetres; null of a joint that slides. */
  shift_mm?: [number, number, number] | null;
  /** Standard deviation of the offset in its unit; null where it is not determined. */
  sigma_offset?: number | null;
  /** Its standard deviation (root mean square), millimetres. */
  sigma_shift_mm?: number | null;
  /** Its standard deviation (root mean square), degrees. */
  sigma_tilt_deg?: number | null;
  /** Tilt of the axis: a rotation vector across it, degrees. */
  tilt_deg: [number, number, number];
  /** In words, with standard deviations. */
  words: string;
};

/** Sampled and allowed values of a joint (radians; metres of a prismatic joint). */
export type JointCoverage = {
  /**
   * Share of the sampled range, at its ends, that at most a fiftieth of the rows reach. A gap of more than 15 % of the range separates it
   * from the rest. It does not count as sampled.
   */
  isolated_share?: number;
  /** The joint. */
  joint: string;
  /** Largest allowed value. */
  limit_max?: number | null;
  /** Smallest allowed value; null without limits, or with placeholders. */
  limit_min?: number | null;
  /** Largest value sampled. */
  sampled_max: number;
  /** Smallest value sampled. */
  sampled_min: number;
};

/** A calibrated joint. */
export type JointEntry = {
  /** Calibrated frame of the joint and of the link that it moves, at zero. */
  base_from_joint: PoseEntry;
  /** The joint whose compliance this joint is. It turns by its terms alone, whose functions are of that joint. */
  compliance_of?: string | null;
  /** Kind. */
  kind: KindWord;
  /** Lower and upper limit, radians or metres. */
  limits?: [number, number] | null;
  /** Name. */
  name: string;
  /** Screw of the nominal model. */
  nominal_screw: ScrewEntry;
  /** Coefficients of the nominal model's terms. */
  nominal_terms?: { [name: string]: number };
  /** Body that carries the joint, if that is not the link of the joint before. */
  on?: BodyEntry | null;
  /** The joint's value as a function of a reading. */
  reading: ReadingEntry;
  /** Calibrated screw in the base frame at zero. */
  screw: ScrewEntry;
  /** Coefficients of terms of the joint's value, in radians, metres, or by value: the value is the reading's, plus these terms. */
  terms?: { [name: string]: number };
};

/** A part of a joint's range. Errors in milliradians, of a joint that slides in millimetres. */
export type JointErrorEntry = {
  /** Error of the calibrated model. */
  calibrated: number;
  /** Error of the corrected model. */
  corrected: number;
  /** Lower end, radians or metres. */
  from: number;
  /** Number of rows. */
  rows: number;
  /** Its standard deviation. */
  sigma: number;
  /** Mean deviation by the joint's own terms. */
  terms: number;
  /** Upper end. */
  to: number;
};

/** Error of a joint over its sampled range: the motion of the joint that explains most of the residuals there. */
export type JointErrorsEntry = {
  /** The joint. */
  joint: string;
  /** Parts of its range with enough rows. */
  parts: JointErrorEntry[];
};

/** Errors of held-out positions or rotations compared with their predicted uncertainty. */
export type KeptEntry = {
  /** Expected root mean square error between measured and predicted, millimetres or degrees. */
  expected_rms: number;
  /** Share of the errors within their own 95 % bound, 0 to 1. */
  inside_bound95: number;
};

/** Kind of a joint. */
export type KindWord = "revolute" | "prismatic";

/** Errors of the rows of a fold or block, predicted by a fit of the others. */
export type LeftOutEntry = {
  /** Name of the block. */
  left_out: string;
  /** Root mean square error of each measured quantity, millimetres or degrees. */
  rms: MeasuredOfNumber;
  /** Number of rows. */
  rows: number;
};

/** Level of a verdict: the permitted use of the delivered model. */
export type Level = "do_not_use" | "located" | "measured_configurations" | "inside_sampled_range" | "good";

/**
 * Loss of robust estimation, a function of the length of a row's whitened residual. Its constant leads to 95 % efficiency under normal
 * noise of that many components.
 */
export type Loss = "huber" | "cauchy" | "tukey";

/** A mass of the model. */
export type MassEntry = {
  /** Mass, kg. */
  mass_kg: number;
  /** Its body. */
  on: BodyEntry;
  /** Its centre at zero joint values, base frame, metres. */
  place_m: [number, number, number];
};

/** Measured quantities of a target. */
export type MeasuredEntry = "pose" | "position" | "nothing";

/** Of each quantity that was measured; null of a rotation that was not. */
export type MeasuredOfImprovement = {
  contact_mm?: Improvement;
  distance_mm?: Improvement;
  height_mm?: Improvement;
  position_mm?: Improvement;
  rotation_deg?: Improvement | null;
  tilt_deg?: Improvement;
};

/** Of each quantity that was measured; null of a rotation that was not. */
export type MeasuredOfKeptEntry = {
  contact_mm?: KeptEntry;
  distance_mm?: KeptEntry;
  height_mm?: KeptEntry;
  position_mm?: KeptEntry;
  rotation_deg?: KeptEntry | null;
  tilt_deg?: KeptEntry;
};

/** Of each quantity that was measured; null of a rotation that was not. */
export type MeasuredOfNumber = {
  contact_mm?: number;
  distance_mm?: number;
  height_mm?: number;
  position_mm?: number;
  rotation_deg?: number | null;
  tilt_deg?: number;
};

/**
 * Errors of one model on one set of rows, of each quantity: distance from measured to predicted position (millimetres), angle from measured
 * to predicted orientation (degrees).
 */
export type ModelAccuracy = {
  contact_mm?: Statistic;
  distance_mm?: Statistic;
  height_mm?: Statistic;
  /** Errors of the corners of all pictures; absent if there are none. */
  pixels?: PixelAccuracy | null;
  position_mm?: Statistic;
  /**
   * Residuals of all rows measured by a device without a frame of its own, millimetres, for any quantity: the remaining violation of their
   * constraint, as the error of a distance, the distance of a ball from the middle of its socket, or a height over its plane. Absent if
   * there are none.
   */
  residual_mm?: Statistic | null;
  rotation_deg?: Statistic | null;
  tilt_deg?: Statistic;
};

/** Motion in a stream, by its own clock. */
export type MotionEntry = {
  /** Time of the first row, seconds; all other times are after it. */
  begin_s: number;
  /** Time of the last row, seconds. */
  end_s: number;
  /** Begin and end of the times without a row, such as lost frames, seconds; the longest 1,000. */
  gaps_s?: Array<[number, number]>;
  /** Rows. */
  rows: number;
  /** Speed of the nominal robot's tip, or of the target that was seen most, over each step, mm/s; null if no row is near. */
  speeds_mm_s: Array<number | null>;
  /** Begin and end of each static interval, seconds; both are equal for a single point. */
  stands_s: Array<[number, number]>;
  /** Seconds from one speed to the next; zero without speeds. */
  step_s: number;
};

/** Noise by which residuals were weighted if a row stated none. */
export type NoiseEntry = {
  /** Standard deviation of each component of each measured quantity, millimetres or degrees. */
  sigma: MeasuredOfNumber;
  /** Source of the noise. */
  source: NoiseSource;
};

/** Source of the noise. */
export type NoiseSource = "given" | "rows" | "estimated" | "exact";

/**
 * Indices O1 to O5 of sun2008 over the singular values `s₁ ≥ … ≥ sₙ` of the whitened Jacobian of the scaled minimal unknowns: theory.md §7
 * (36b). Larger is better. `None` where a singular value is zero but for rounding.
 */
export type Observability = {
  /** `(s₁ s₂ … sₙ)^(1/n) / √m`, 1/m (metre): the geometric mean of the singular values, by the number m of configurations. */
  o1?: number | null;
  /** `sₙ / s₁`: the inverse of the condition number. */
  o2?: number | null;
  /** `sₙ`, 1/m (metre): the inverse of the largest standard deviation. */
  o3?: number | null;
  /** `sₙ² / s₁`, 1/m (metre): the noise amplification index. */
  o4?: number | null;
  /** `1 / Σ 1/sₖ`, 1/m (metre). */
  o5?: number | null;
};

/** Offset of a joint. */
export type OffsetEntry = {
  /** The joint. */
  joint: string;
  /** Offset of a revolute joint, degrees. */
  offset_deg?: number | null;
  /** Offset of a prismatic joint, millimetres. */
  offset_mm?: number | null;
};

/**
 * The URDF that was calibrated, with the selection of its chain. Every URDF form of the result is this text with other numbers, so that
 * meshes, comments and links outside the chain remain.
 */
export type OriginalUrdf = {
  /** First link of the chain. */
  base_link?: string | null;
  /** Instruments on the robot, each with its link. */
  instruments?: { [name: string]: string };
  /** SHA-256 of the text. */
  sha256: string;
  /** Targets on any link, each with it. */
  targets?: { [name: string]: string };
  /** The whole text. */
  text: string;
  /** Last link of the chain. */
  tip_link?: string | null;
};

/** A suspected outlier. */
export type OutlierEntry = {
  /** Its file, as named by the user. */
  file: string;
  /**
   * Residual of each measured quantity against the calibrated model's prediction, millimetres or degrees: distance of positions, angle of
   * orientations, and so on.
   */
  residual: MeasuredOfNumber;
  /** Its line in that file, from 1. */
  row: number;
  /** Its set. */
  set: OutlierSet;
  /** Studentised residual: length over its own standard deviation. */
  studentized: number;
  /** Weight in the fit, 0 to 1; for a held-out row the weight that it would have had. */
  weight: number;
};

/** Set of a suspected row. */
export type OutlierSet = "fit" | "held_out";

/** A value for the training rows and one for the held-out rows. */
export type OutliersBySet = {
  /** Value of the held-out rows. */
  held_out: number;
  /** Value of the training rows. */
  training: number;
};

/** A value for the training rows and one for the held-out rows. */
export type OutliersBySet2 = {
  /** Value of the held-out rows. */
  held_out?: SetAccuracy | null;
  /** Value of the training rows. */
  training?: SetAccuracy | null;
};

/** The pictures of the session: their noise, and the lenses by which they were read. */
export type PicturesEntry = {
  /** The boards. */
  boards?: BoardEntry[];
  /** The cameras. */
  cameras: CameraEntry[];
  /** Error that all corners of a picture share: the error of the configuration. */
  common: CommonEntry;
  /** Number of corners in them. */
  corners: number;
  /** Number of pictures. */
  count: number;
  /**
   * Numbers of cameras and boards that were fitted together with the robot (`--free lens`, `board`, `markers`) and replace those above;
   * absent if all were held.
   */
  found?: FoundEntry[];
  /** Errors of corners over the image of each camera whose picture has a known size. */
  images?: ImageEntry[];
  /** Standard deviation of each coordinate of a corner that states none, pixels. */
  sigma_px: number;
  /** Corners that lost their weight, since they do not fit the others of their picture. */
  without_weight: number;
};

/** Distances of corners from their prediction by a model: in the picture, and at the board, perpendicular to the ray. */
export type PixelAccuracy = {
  /** Number of corners. */
  corners: number;
  /** Largest, pixels. */
  max_px: number;
  /** Mean over the corners, pixels. */
  mean_px: number;
  /** Median over the pictures of the root mean square of each, pixels. */
  median_picture_px: number;
  /** Median over the corners, pixels. */
  median_px: number;
  /** Number of pictures. */
  pictures: number;
  /** Root mean square over the corners at the board, perpendicular to the ray, millimetres. */
  rms_mm: number;
  /** Root mean square over the corners, pixels. */
  rms_px: number;
  /** Corners behind the camera or beyond its lens by the model; no statistic includes them. */
  unseen?: number;
};

/** A point of a body. */
export type PointEntry = {
  /** Name. */
  name: string;
  /** Position in the frame of the body, millimetres. */
  place_mm: [number, number, number];
};

/** Accuracy of each model in a pose, millimetres or degrees. */
export type PoseAccuracy = {
  /** Accuracy of the calibrated model. */
  calibrated: MeasuredOfNumber;
  /** Accuracy of the nominal model. */
  nominal: MeasuredOfNumber;
  /** Accuracy of the registered model. */
  registered: MeasuredOfNumber;
};

/** A pose. */
export type PoseEntry = {
  /** Position, metres. */
  position_m: [number, number, number];
  /** Unit quaternion x, y, z, w. */
  quaternion_xyzw: [number, number, number, number];
};

/** A part of a joint's range with the expected error there. */
export type RangeEntry = {
  /** Lower end, radians or metres. */
  from: number;
  /** The joint. */
  joint: string;
  /** Root mean square distance, millimetres, with the other joints anywhere in their ranges. */
  sigma_position_mm: number;
  /** Upper end. */
  to: number;
};

/** Correction of a reading. */
export type ReadingChangeEntry = {
  /** Largest. */
  max: number;
  /** Median. */
  median: number;
  /** The reading. */
  reading: string;
  /** Unit of the numbers: `deg`, or `mm` of a joint that slides. */
  unit: string;
};

/** `value = multiplier * reading + offset`. */
export type ReadingEntry = {
  /** Factor. */
  multiplier: number;
  /** Name of the reading. */
  name: string;
  /** Offset, radians or metres. */
  offset: number;
};

/** A joint that was recalibrated; everything else is as in the earlier calibration. */
export type RecalibratedEntry = {
  /** The earlier calibration. */
  calibration: string;
  /** The joint. */
  joint: string;
  /** The measurement files. */
  measurements: string[];
  /** Motion of the axis in the base's axes, and for a zero of all that follows the joint: metres and radians, linear part first. */
  motion: [number, number, number, number, number, number];
  /** Its recalibrated part. */
  part: RepairedPart;
  /** Number of measurements that repeat configurations of earlier ones. */
  repeated: number;
  /** Number of measurements. */
  rows: number;
  /** SHA-256 of each, by name. */
  sha256: { [name: string]: string };
  /** Standard deviation of that. */
  sigma: number;
  /** Change of its zero, degrees; for a joint that slides, millimetres. For an axis its turn, degrees. */
  size: number;
};

/** Statements about a session, for its report: after ISO/IEC 17025:2017, 7.8.2. poecal computes nothing from them. */
export type Record = {
  /** Number of the report or certificate. */
  certificate?: string | null;
  /** Customer of the calibration. */
  customer?: string | null;
  /** Day of the measurements, `YYYY-MM-DD`. */
  date?: string | null;
  /** The measuring instrument: its serial number and its own certificate. */
  instrument?: string | null;
  /** Day of the instrument's own calibration, `YYYY-MM-DD`. */
  instrument_calibrated?: string | null;
  /** Name and address of the calibrating laboratory. */
  laboratory?: string | null;
  /** Anything else. */
  note?: string | null;
  /** Person who measured. */
  operator?: string | null;
  /** The load that the robot carried, with its unit. */
  payload?: string | null;
  /** Location of the robot. */
  place?: string | null;
  /** The robot's name used by its owner: maker and type. */
  robot?: string | null;
  /** Its serial number. */
  serial?: string | null;
  /** The speed of a test, like `100 %` or `500 mm/s`. */
  speed?: string | null;
  /** Temperature there, with its unit, `21.5 °C` or `21.5 ± 0.5 °C`. */
  temperature?: string | null;
  /** The tool that was on the flange. */
  tool?: string | null;
  /** Day until which the certificate is valid, `YYYY-MM-DD`. */
  valid_until?: string | null;
  /** Warm-up of the robot before a test. */
  warm_up?: string | null;
};

/** The part of a joint that was recalibrated. */
export type RepairedPart = "zero" | "axis";

/** Pose accuracy and repeatability of positions, after ISO 9283; for poses that were measured by other quantities those of the latter. */
export type RepeatabilityEntry = {
  /** Distance from the prediction of each model to the mean measured position. */
  accuracy: PoseAccuracy;
  /** The poses, those with most rows first, at most 100. */
  listed: RepeatedPoseEntry[];
  /** Number of targets in configurations with three rows or more. */
  poses: number;
  /** Repeatability: mean distance of measured positions from their mean, plus three standard deviations. */
  repeatability: MeasuredOfNumber;
  /** Number of their rows. */
  rows: number;
  /** The largest repeatability. */
  worst_repeatability: MeasuredOfNumber;
};

/** A configuration that was measured several times. */
export type RepeatedPoseEntry = {
  /** Distance from the prediction of each model to the mean measured position. */
  accuracy: PoseAccuracy;
  /** File of its first row. */
  file: string;
  /** Repeatability: mean distance of measured positions from their mean, plus three standard deviations. */
  repeatability: MeasuredOfNumber;
  /** Line of its first row, from 1. */
  row: number;
  /** Number of its rows. */
  rows: number;
};

/** The calibrated robot's frames. */
export type RobotEntry = {
  /** Pose of the tip in the base with all joint values zero. */
  base_from_tip_at_zero: PoseEntry;
  /** Name of the base frame. */
  base_link: string;
  /** Other values that are read in each configuration and that terms depend on; the term `factor1` is of the first. */
  factors?: FactorReading[];
  /** Weights that the robot carries, if its joints sag. */
  gravity?: GravityEntry | null;
  /** Masses of the model's links; the term `masses` is of all of them. */
  masses?: MassEntry[];
  /** Name. */
  name: string;
  /** Pose of the tip in the base with all joint values zero, by the nominal model. */
  nominal_base_from_tip_at_zero: PoseEntry;
  /** Name of the tip frame. */
  tip_link: string;
  /** Body of the tip, if it is not the last joint's link. */
  tip_on?: BodyEntry | null;
};

/** Treatment of outliers. */
export type RobustEntry = {
  /** Loss of a robust fit; null: least squares. */
  loss?: Loss | null;
  /** Numbers of suspected rows. */
  suspected: OutliersBySet;
  /** `accuracy` without suspected rows; null for a set that has none. */
  without_suspected: OutliersBySet2;
};

/** A row of a file. */
export type RowEntry = {
  /** Its line, row of a sheet or message; that of its first row for a static interval. */
  line: number;
  /** Its number among the rows or static intervals, from 1. */
  number: number;
};

/** A screw, linear part first. */
export type ScrewEntry = {
  /** Linear part: metres of an axis, a unit vector of a sliding direction. */
  v_m: [number, number, number];
  /** Angular part: a unit vector of an axis, zero of a sliding direction. */
  w: [number, number, number];
};

/** Errors of the three models on one set of rows. */
export type SetAccuracy = {
  /** Screws fitted too. */
  calibrated: ModelAccuracy;
  /** Screws and terms of the joints fitted together; absent if no terms were requested. */
  corrected?: ModelAccuracy | null;
  /** Number of measurements. */
  count: number;
  /** Ratio of the registered model's errors to those of the fitted models, on held-out rows; absent for other rows. */
  improvement?: Improvements | null;
  /** The nominal model; only an unknown device frame is fitted. */
  nominal: ModelAccuracy;
  /** Device frame and targets fitted, screws nominal. */
  registered: ModelAccuracy;
};

/** Reason for the sizes of a corrected model's terms. */
export type SizesReason = "given" | "predict" | "no_better" | "small" | "too_few" | "undetermined" | "led_nowhere" | "worse_held_out";

/** The minimisation: steps, end, convergence. */
export type SolverEntry = {
  /** Tolerance of the prior, if cross-validation chose it. */
  chosen_tolerance?: ToleranceEntry | null;
  /** True if an optimum was reached. */
  converged: boolean;
  /** Parameterisation of joint errors: `adjoint`, or a formulation for comparison. */
  formulation?: string;
  /** Iterations of the full fit. */
  iterations: number;
  /**
   * Fitted joint offsets: joint value minus reading, if the formulation contains them. Data cannot separate them from screws; in `joints`
   * they are part of the screws, and the readings need no correction.
   */
  joint_offsets?: OffsetEntry[] | null;
  /** Method of the solver: `levenberg-marquardt`, or others for comparison. */
  method?: string;
  /** Effect of the formulation on the result, if it is not the default one. */
  note?: string | null;
  /** Residual of measured frames: `tool`, at the target, or another for comparison. */
  pose_residual?: string;
  /** Number of further starts after a suspected local minimum. */
  restarts: number;
  /** Reason of its end. */
  termination: Termination;
  /** Mean square of the whitened residual by iteration, the start first; each re-weighted round of the fit starts again. */
  trace?: number[];
};

/** Median and largest of some sizes. */
export type SpreadEntry = {
  /** Largest. */
  max: number;
  /** Median. */
  median: number;
};

/** A station of the measuring device. */
export type StationEntry = {
  /** Pose of the device in the base; of an instrument on the robot, at zero joint values. */
  base_from_device: PoseEntry;
  /** Name of the instrument: from the column `instrument`, or the file with `--device-frames per-file`. */
  instrument?: string | null;
  /**
   * SessionKind, if it is no instrument with a frame of its own: anchor, socket, plane (z is its normal), sphere, direction (z is along
   * it), pair (of configurations, without a meaningful pose).
   */
  kind?: string | null;
  /** Radius of a sphere, with that of the probe, known or found, millimetres. */
  radius_mm?: number | null;
  /** Scale error of its distance readings (scale less 1), if it is not 0. */
  scale?: number | null;
  /** Standard deviation of each component of its measurements that state none, if it differs from that of the first instrument. */
  sigma?: MeasuredOfNumber | null;
  /** Reading of its distances at its own position, millimetres, if it is not 0; for a sphere that is touched, minus its radius. */
  zero_mm?: number | null;
};

/** Mean, root mean square, 95th percentile (linear between ranks) and maximum of errors. */
export type Statistic = {
  /** Largest. */
  max: number;
  /** Mean. */
  mean: number;
  /** 95th percentile. */
  p95: number;
  /** Root mean square. */
  rms: number;
};

/**
 * A configuration in which every measured position is suspected, of two targets or more, with residuals of similar length. There the arm or
 * its readings are wrong, not a target.
 */
export type SuspectedConfigurationEntry = {
  /** File of its first row. */
  file: string;
  /** Largest residual of position, millimetres. */
  largest_mm: number;
  /** Smallest residual of position, millimetres. */
  least_mm: number;
  /** Line of its first row, from 1. */
  row: number;
  /** Number of its rows. */
  rows: number;
  /** Number of their targets. */
  targets: number;
};

/** A target; a point has no orientation. */
export type TargetEntry = {
  /** The measured quantities of such a target; the rest of its pose is the model's. */
  measured?: MeasuredEntry | null;
  /** Body of a target that is not in the tip frame: its pose is in the frame of the joint that moves the body, or in the base. */
  on?: BodyEntry | null;
  /** Position, metres. */
  position_m: [number, number, number];
  /** Unit quaternion x, y, z, w, where orientation was measured; of a target on a body of its own, always. */
  quaternion_xyzw?: [number, number, number, number] | null;
};

/** Reason of the end of a minimisation: data, not an error string. */
export type Termination = "optimum" | "step_vanished" | "no_progress" | "iteration_limit" | "not_finite";

/** Reference of a third axis. */
export type ThirdAxisWord = "arm" | "level";

/** Tolerance of the prior: expected deviation of each axis from nominal, standard deviations. */
export type ToleranceEntry = {
  /** Tolerance of its direction, degrees. */
  angle_deg: number;
  /** Tolerance of its position, millimetres. */
  length_mm: number;
};

/** Sizes that were tried. */
export type TriedEntry = {
  /** Error (RMS) of parts that were left out, over that of geometry alone: a geometric mean over the parts. Six decimals. */
  left_out: number;
  /** Logarithm of its square with the prior of the choice: the least was chosen. Six decimals. */
  score: number;
  /** The sizes. */
  sizes: { [name: string]: number };
};

/** Covariance of the unknowns, and expected errors. */
export type UncertaintyEntry = {
  /**
   * Frames `base_from_axis` at zero, z along the joint, of each joint's unknowns: shifts along x and y and turns about x and y of a
   * revolute joint, turns about x and y of a prismatic one.
   */
  axes: PoseEntry[];
  /** Bootstrap at measured configurations; null with too few rows. */
  bootstrap?: BootstrapEntry | null;
  /** Correlations of the unknowns, by blocks; missing in older files and of the corrected model. */
  correlations?: CorrelationsEntry | null;
  /**
   * Covariance of the unknowns, square metres, turns multiplied by `length_m`: the upper triangle by rows, in the order of the fit with
   * pure translations first.
   */
  covariance_m2: number[];
  /** Covariance outside the sampled range; absent if no larger. */
  covariance_outside_m2?: number[] | null;
  /** Degrees of freedom of the variance of each quantity's residuals; absent where their noise is stated. */
  degrees_of_freedom?: { [name: string]: number };
  /** Factor outside the sampled range; absent if no larger. */
  extrapolation?: number | null;
  /** Point of the device frame about which its unknowns turn, metres, where the frame is among them. */
  frame_about_m?: [number, number, number] | null;
  /** Errors of held-out rows compared with their predicted uncertainty; null without such rows. */
  held_out?: MeasuredOfKeptEntry | null;
  /** Factor of the covariance over that of independent residuals. */
  inflation: number;
  /** Correlation of residuals of consecutive rows; null if not significant. */
  lag_one_correlation?: number | null;
  /** Metres that one radian equals in the covariance. */
  length_m: number;
  /** Expected errors in the measured configurations. */
  measured: ExpectedEntry;
  /** Model error: standard deviation of each component, millimetres or degrees; of positions, rotations and other measured quantities. */
  model_error: MeasuredOfNumber;
  /** Measurement noise in the residuals: standard deviation of each component, millimetres or degrees. */
  noise: MeasuredOfNumber;
  /** Expected errors by parts of each joint's range. */
  parts: RangeEntry[];
  /** Expected errors anywhere within the limits. */
  range: ExpectedEntry;
  /** Attribution of the residuals of each quantity to the robot or to the instrument. */
  residuals: { [name: string]: Attribution };
  /**
   * Targets with unknowns, `true` for frames: shifts along their axes, and for frames turns about them. One that is the tip has an empty
   * name.
   */
  targets: Array<[string, boolean]>;
  /** Names of the unknowns, in the order of the covariance; missing in older files. */
  unknowns?: string[];
};

/**
 * A level, and the reasons against a better one; for the best level, the reasons for it. It includes the expected errors of the delivered
 * model.
 */
export type Verdict = {
  /** Mean of the distances that 95 % of its errors do not exceed there, millimetres. */
  bound95_mm?: number | null;
  /** Statement that the axes of the nominal model are confirmed, with its figures: the fitted ones are the same within their uncertainty. */
  confirmed?: string | null;
  /**
   * Expected error of its predictions in configurations like those that were measured, millimetres (RMS); absent if no use is advised, or
   * nothing is known.
   */
  expected_error_mm?: number | null;
  /** Decision whether it predicts better than the nominal model there. */
  gain?: Gain | null;
  /** Permitted use. */
  level: Level;
  /** The delivered model: the corrected one if it has terms. Missing in older files. */
  model?: AcceptedModel | null;
  /** Distance of the nominal model's predictions from its own there, with targets and devices fitted, millimetres (RMS). */
  nominal_error_mm?: number | null;
  /** Sentences with the deciding figures. */
  reasons: string[];
  /**
   * Expected error of its predictions anywhere inside the sampled range of each joint, millimetres (RMS); absent if no use is advised, and
   * in older files.
   */
  sampled_range_error_mm?: number | null;
};

/** A weight. */
export type WeightEntry = {
  /** Name of the joint that carries it, or of the tip. */
  at: string;
  /** Its body. */
  on: BodyEntry;
  /** Its position at zero joint values, base frame. */
  place_m: [number, number, number];
};

/** A part of the workspace: a ring about the axis, as wide and as high as a cell. */
export type WorkspaceCellEntry = {
  /** Number of configurations. */
  configurations: number;
  /** Its height along the axis above the base's origin, lower end, metres. */
  height_m: number;
  /** Distances, millimetres. */
  position_mm: SpreadEntry;
  /** Distance of the nominal tip from the axis, lower end, metres. */
  radius_m: number;
  /** Angles, degrees. */
  rotation_deg: SpreadEntry;
  /**
   * Expected error of a corrected program in these configurations: of predicted positions, root mean square, millimetres. Missing without
   * an uncertainty, and in files of earlier versions.
   */
  sigma_position_mm?: number | null;
};
