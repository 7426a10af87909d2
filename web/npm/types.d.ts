// Written by web/npm/types.mjs from docs/calibration.schema.json and docs/commands.md.

/** A value of an option, as it would be typed; of an option that may be given again, an array of them. */
export type Value = string | number;

/** Options of `poecal calibrate`, by their long names. */
export interface CalibrateOptions {
  /** What a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names) */
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
   * How rows of a joint file are matched to rows of a measurement file [default: by name, else recordings by the times at which the robot
   * stood still and lists by their order, if the nominal model fits no other match as well]
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
   * How far the axes may be from the model's (the prior): standard deviations of their directions and places, or none. They matter only
   * where the measurements leave an axis open, which then stays near the model. auto chooses by cross-validation among 0.05deg,0.5mm,
   * 0.2deg,2mm, 0.5deg,5mm, 1deg,10mm and 3deg,10mm. A joint of a TOML model may state its own. MOC.cfg of an ABB controller with Absolute
   * Accuracy has the deviations that the maker found [default: 0.5deg,5mm]
   */
  tolerance?: Value | readonly Value[];
  /**
   * What joints do beyond geometry: auto fits the terms that predict rows best which were not fitted, all looks among more of them; groups
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
   * Where gravity pulls, in the robot's base frame, like 0,0,1 for a robot on the ceiling; find takes the direction with which the terms
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
  /** How to treat outliers: auto fits by least squares, and by the tukey loss where that shows outliers */
  robust?: "auto" | "off" | "huber" | "cauchy" | "tukey";
  /** What to do where a device, a target, a nest or a joint's zero moved during the session, or configurations are wrong as a whole */
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
   * What the report states of the session, like serial=4711 (repeatable): certificate, laboratory, customer, robot, serial, instrument,
   * instrument_calibrated, tool, payload, speed, warm_up, operator, date, place, temperature, valid_until or note
   */
  record?: Value | readonly Value[];
}

/** Options of `poecal validate`, by their long names. */
export interface ValidateOptions {
  /** What a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names) */
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
   * How rows of a joint file are matched to rows of a measurement file [default: by name, else recordings by the times at which the robot
   * stood still and lists by their order, if the nominal model fits no other match as well]
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
  /** What the report states of this session, like operator=Mia (repeatable): the keys of `poecal calibrate` */
  record?: Value | readonly Value[];
  /** File to which the check is appended as a line, or `none` [default: history.jsonl beside the calibration] */
  history?: Value | readonly Value[];
}

/** Options of `poecal predict`, by their long names. */
export interface PredictOptions {
  /** What a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names) */
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
  /** What a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names) */
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
   * How rows of a joint file are matched to rows of a measurement file [default: by name, else recordings by the times at which the robot
   * stood still and lists by their order, if the nominal model fits no other match as well]
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
  /** What a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names) */
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
  /** Whether the tool with its targets will be on the flange as it was [default: same] */
  tool?: "same" | "refit";
  /** Rows of an earlier visit whose configurations may be repeated [default: the measurements that the calibration was made of] */
  reference?: Value | readonly Value[];
  /** What will be measured of the tip */
  kind?: "pose" | "mixed" | "relative" | "point" | "component" | "distance" | "ball-bar" | "distance-change" | "sphere" | "socket" | "plane" | "height" | "flush" | "direction";
  /** Number of different configurations to fit [with --purpose drift: to measure at each visit, by default 8] [default: 30] */
  count?: Value | readonly Value[];
  /** Number of further rows to judge by, at random over the workspace [default: a third of the configurations] */
  heldOutCount?: Value | readonly Value[];
  /** Choose from these configurations alone (a table of joint readings) */
  candidates?: Value | readonly Value[];
  /**
   * Where the robot will work and predictions shall be good: anywhere within its limits, in the configurations of a file, or with the tip
   * in a box of the base frame, from one corner to the other [default: limits]
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
  /** What the list shall be good at */
  criterion?: "expected" | "D" | "A" | "E" | "G";
  /** Number of targets of a nest at the tip, all measured in each configuration [default: 1] */
  targets?: Value | readonly Value[];
  /**
   * Where the target is in the tip's frame, of several the first, the others turned about z, like 50,0,30mm [default: the targets of the
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
   * How far the axes may be from the model's (the prior of the fit): standard deviations of their directions and places, or none [default:
   * 0.5deg,5mm]
   */
  tolerance?: Value | readonly Value[];
  /**
   * What joints are expected to do beyond geometry: auto and all terms of the common sizes, off nothing, or groups with their sizes, as of
   * poecal calibrate [default: auto]
   */
  corrections?: Value | readonly Value[];
  /** Where gravity pulls, in the robot's base frame [default: 0,0,-1] */
  gravity?: Value | readonly Value[];
  /** How far every joint stays from its limits [default: 2deg,5mm; of a list that is stated none] */
  margin?: Value | readonly Value[];
  /** Box into which no part of the robot may reach, by two corners (repeatable) */
  keepOut?: Value | readonly Value[];
  /** Height above which all links that move stay, like 20mm */
  floorHeight?: Value | readonly Value[];
  /** Least change of some joint between any two configurations */
  separation?: Value | readonly Value[];
  /**
   * Where the measuring device is; targets that links hide from it are left out. With --purpose drift: known where it will stand as it
   * stood, as on fixed nests, or refit
   */
  device?: Value | readonly Value[];
  /** Half the angle of the device's cone, about the direction from it to --device-aim */
  deviceHalfAngle?: Value | readonly Value[];
  /** Where the device looks [default: the base] */
  deviceAim?: Value | readonly Value[];
  /** Least and largest distance of the target from the device, like 0.5m:10m */
  distance?: Value | readonly Value[];
  /** Largest angle between the direction in which the target looks and the line to the device: of a reflector or a board */
  targetHalfAngle?: Value | readonly Value[];
  /** The direction in which the target looks, in its own frame [default: 0,0,1] */
  targetNormal?: Value | readonly Value[];
  /** Whether links may overlap by their shapes in the URDF: capsules around these, so that a little room is lost */
  selfCollision?: "avoid" | "ignore";
  /** How long the robot stands at each row, for how long all takes [default: 30s] */
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
  /** What a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names) */
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
  /** What a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names) */
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
   * What the joints do beyond geometry: groups of terms with the standard deviations of their random coefficients in radians or metres,
   * sag, tilt, ratio, harmonics, wobble, backlash, factors, payload, shift, runout [default: off]
   */
  terms?: Value | readonly Value[];
  /** Where gravity pulls, in the robot's base frame [default: 0,0,-1] */
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
  /** Whether the limits that were asked for are kept; absent if none were. */
  acceptance?: Acceptance | null;
  /** Errors of the nominal, registered and calibrated model on training and held-out rows. */
  accuracy: Accuracy;
  /** What was fitted and what held, where that is not the usual: all axes, targets and frames. */
  blocks?: BlocksEntry | null;
  /** Clocks of instruments that measured in motion; absent where none did. */
  clocks?: ClockEntry[];
  /** Directions in which corrections of several joints are known only together; absent where there is none. */
  common?: CommonDirectionEntry[];
  /**
   * How far programs for the nominal robot miss in the sampled workspace, and the corrections of the joints that mend it; absent where the
   * calibration is not to be used, and of a robot whose tip not every joint moves.
   */
  compensation?: CompensationEntry | null;
  /** How the readings of the joints are made of those that the controller counts; absent where they are the same. */
  controller?: Controller | null;
  /** The corrected model: screws and terms of the joints fitted together; absent if no terms were asked for. */
  corrected?: CorrectedEntry | null;
  /** Each joint's correction. */
  corrections?: CorrectionEntry[];
  /** Sampled part of each joint's range. */
  coverage?: JointCoverage[];
  /** Cross-validation: errors of rows that are predicted by a fit of the others; null if there are too few. */
  cross_validation?: CrossValidationEntry | null;
  /** Mistakes in the input: named, not corrected. */
  diagnosis?: DiagnosisEntry[];
  /** Which unknowns the measurements determine. */
  identifiability: IdentifiabilityEntry;
  /** Inputs. */
  inputs: Inputs;
  /** Instruments on the robot. */
  instruments?: { [name: string]: InstrumentEntry };
  /** The calibrated joints from base to tip. */
  joints: JointEntry[];
  /** Frame of the measuring device. */
  measurement_frame: FrameEntry;
  /** Whether the point that was measured became the tip (`--move-tip`); otherwise the tip is where the model has it on the last link. */
  move_tip?: boolean;
  /** Noise by which residuals were weighted. */
  noise: NoiseEntry;
  /** Suspected rows, the worst first, at most 1,000; `robust` has their number. */
  outliers?: OutlierEntry[];
  /** The pictures, their noise and lenses; absent if there are none. */
  pictures?: PicturesEntry | null;
  /** Version of the program. */
  poecal_version: string;
  /** Joints that were calibrated anew since, by `poecal track --recalibrate`, in order; all else is of the calibration before. */
  recalibrated?: RecalibratedEntry[];
  /** What is stated of the session; absent if nothing is. */
  record?: Record;
  /** What happened during the session and was repaired; all else in this file is of the repaired session. */
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
  /** Configurations in which all targets are suspected and off alike, the worst first, at most 100: the arm or its readings are wrong there. */
  suspected_configurations?: SuspectedConfigurationEntry[];
  /** What seems to have happened and was not repaired. */
  suspicions?: Event[];
  /**
   * Targets by their names, `measured` where no row names one: in the tip frame, or on a body of their own (`on`). None where `move_tip` is
   * true.
   */
  targets: { [name: string]: TargetEntry };
  /** Pose of the tip in the last joint's frame. */
  tool: PoseEntry;
  /** Expected errors of predictions; null without more residuals than unknowns. */
  uncertainty?: UncertaintyEntry | null;
  /** Verdict: whether the result is good to use, and where. */
  verdict?: Verdict | null;
  /** Warnings, a sentence each. */
  warnings?: string[];
};

/** Whether a calibration keeps the limits that were asked for. */
export type Acceptance = {
  /** By which rows. */
  by: AcceptedRows;
  /** The worst decision of all limits. */
  decision: Decision;
  /** Each limit, by quantity. */
  limits: AcceptedLimit[];
  /** Which model was judged. */
  model: AcceptedModel;
};

/** A limit, what was found, and the decision. Numbers are in millimetres or degrees. */
export type AcceptedLimit = {
  /** Number of different configurations among them, which are what counts. */
  configurations: number;
  /** What that says of the limit. */
  decision: Decision;
  /** What the rows have. */
  found: number;
  /** Lower bound, with 95 % confidence. */
  from: number;
  /** The limit. */
  limit: number;
  /** The measured quantity: `position`, `rotation` and so on. */
  quantity: string;
  /** Number of rows that measured the quantity. */
  rows: number;
  /** What of the errors is limited. */
  statistic: AcceptedStatistic;
  /** Upper bound, with 95 % confidence; null where the rows are too few for one. */
  to?: number | null;
  /** Unit of the numbers: `mm` or `deg`. */
  unit: string;
};

/** Which model is judged. */
export type AcceptedModel = "corrected" | "calibrated";

/** Which rows decided. */
export type AcceptedRows = "held_out" | "cross_validation" | "judged";

/** What of the errors is limited. */
export type AcceptedStatistic = "rms" | "p95" | "max";

/** Errors on training and held-out rows. */
export type Accuracy = {
  /** Number of configurations where all were fitted because too few would have been held out; absent otherwise. */
  few_configurations?: number | null;
  /** On the held-out rows; null if there are none. */
  held_out?: SetAccuracy | null;
  /** On the training rows. */
  training: SetAccuracy;
};

/** Whether the residuals count as the robot's or the instrument's. */
export type Attribution = "robot" | "stated_noise" | "repeats";

/** Tilt and shift of an axis. */
export type AxisEntry = {
  /** Of its place, millimetres; null of a joint that slides. */
  shift_mm?: number | null;
  /** Of its direction, degrees. */
  tilt_deg?: number | null;
};

/** Blocks of unknowns by name: `JOINT.axis`, `JOINT.offset` and other terms, `target.NAME`, `frame.NAME`. */
export type BlocksEntry = {
  /** Fitted. */
  free: string[];
  /** Held as in the model; terms that are none are not listed. */
  held: string[];
};

/** A body of known points. */
export type BoardEntry = {
  /** Its name. */
  name: string;
  /** Its points. */
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
  /** The same by the covariance, for white noise, millimetres. */
  formal_sigma_position_mm: number;
  /** Root mean square distance over these samples, millimetres. */
  sigma_position_mm: number;
};

/** Of the training rows and of those held out. */
export type BySet = {
  /** Of the held-out rows. */
  held_out: number;
  /** Of the training rows. */
  training: number;
};

/** Of the training rows and of those held out. */
export type BySet2 = {
  /** Of the held-out rows. */
  held_out?: SetAccuracy | null;
  /** Of the training rows. */
  training?: SetAccuracy | null;
};

/** A camera with its lens. */
export type CameraEntry = {
  /** Where the axis meets the picture, pixels; the centre of the first pixel is (0, 0). */
  centre_px: [number, number];
  /** Coefficients of the distortion. */
  distortion: number[];
  /** Focal lengths along u and v, pixels. */
  focal_px: [number, number];
  /** `brown` with k1, k2, p1, p2, k3, k4, k5, k6 in OpenCV's order, or `fisheye` with k1 to k4. */
  model: string;
  /** Its name. */
  name: string;
  /** Width and height, pixels; null if they are not known. */
  size_px?: [number, number] | null;
};

/** Why something is not determined. The words stand in `calibration.json` and do not change. */
export type Cause = "own_axis" | "base_frame" | "joint_offsets" | "no_orientation" | "unseen" | "stood_still" | "too_few" | "point_on_axis" | "one_orientation" | "one_turning_direction" | "moved_together" | "small_motion" | "dependent_motion" | "no_length" | "seen_once" | "other";

/** What the common error of the corners of a picture turns about. */
export type Centre = "board" | "camera";

/**
 * The clock of an instrument whose rows were measured in motion, beside that of the joint readings: a measurement at its time t belongs to
 * the readings at `t - lag - drift (t - middle)`.
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
  /** Its standard deviation; absent likewise. */
  sigma_drift_ppm?: number | null;
  /** Its standard deviation, milliseconds; absent where the lag was held, and without more residuals than unknowns. */
  sigma_lag_ms?: number | null;
};

/** A direction in which corrections of several joints are known only together. */
export type CommonDirectionEntry = {
  /** Root mean square change of predicted positions by one standard deviation, at the measured configurations, millimetres. */
  effect_mm: number;
  /** The joints. */
  joints: string[];
  /** Its share in the variance of all corrections, 0 to 1. */
  share: number;
  /** In words: one standard deviation of it, and what it does to predictions. */
  words: string;
};

/** The error that the corners of a picture share: standard deviations of each component. */
export type CommonEntry = {
  /** What it turns about. */
  about: Centre;
  /**
   * By how many times more than by their own noise the corners move the pose of the board, as in the picture of another lens or board; 1
   * where it is absent.
   */
  corners?: number;
  /** Shift, millimetres. */
  shift_mm: number;
  /** Turn, degrees. */
  turn_deg: number;
};

/**
 * How far the actual robot's tip is from where the nominal one has it, over the sampled workspace; and the corrections of the joints that
 * mend it. Tool and base of the nominal robot are fitted to the actual one (the base only if the device's frame was unknown), over every
 * third configuration, as if both had been taught on it: what is displaced is displaced by the joints. The actual robot is the corrected
 * model, if there is one.
 */
export type CompensationEntry = {
  /** Joint whose axis the map is about; null if that is the base's z axis. */
  about?: string | null;
  /** Configurations whose corrected readings are beyond a joint's limits. */
  beyond_limits: number;
  /** Side of the map's cells, metres. */
  cell_m: number;
  /** Parts of the workspace where the sample has configurations, by height and then by distance from the axis. */
  cells: WorkspaceCellEntry[];
  /** Number of configurations. */
  configurations: number;
  /** Corrections of each reading that moves the tip; none of an arm with fewer than six, which cannot mend every displacement. */
  joints: ReadingChangeEntry[];
  /** Configurations from which no small correction leads to the pose, since a singularity is near: another branch is, or none. */
  not_correctable: number;
  /** Distances, millimetres. */
  position_mm: SpreadEntry;
  /** Angles, degrees. */
  rotation_deg: SpreadEntry;
  /** Configurations whose tip is displaced by no more than is expected of the calibration itself: there is nothing to mend. */
  within_expected_error: number;
};

/**
 * How the readings of a controller make those of the model, `reading = Σ factor · counted + offset`: as where the third axis counts from
 * the level. Kept in `calibration.json` where they are not the same one by one.
 */
export type Controller = {
  /** The readings of the model's joints, in their order. */
  readings: ControllerReading[];
  /** From where the third axis counts, where that was stated; absent where it was not. */
  third_axis?: ThirdAxisWord | null;
};

/** A column of the controller's readings. */
export type ControllerColumn = {
  /** What it is multiplied with. */
  factor: number;
  /** Unit of its numbers in the measurement files. */
  unit: string;
};

/** How a reading of the model is made. */
export type ControllerReading = {
  /** Columns of the measurement files that were summed; none for a constant. */
  columns: { [name: string]: ControllerColumn };
  /** What is added, radians or metres. */
  offset?: number;
  /** Its name. */
  reading: string;
};

/**
 * Screws and terms of the joints, fitted together. Its entries replace those of the same name where predictions are those of the corrected
 * model.
 */
export type CorrectedEntry = {
  /** What each group of terms does at each joint, the one that moves the target most first. */
  effects?: EffectEntry[];
  /** Effects that the measurements do not tell apart, a sentence each. */
  indistinguishable?: string[];
  /** Instruments on the robot. */
  instruments?: { [name: string]: InstrumentEntry };
  /** Error of each joint over its sampled range, before and after. */
  joint_errors?: JointErrorsEntry[];
  /** The joints from base to tip: those of the robot, and behind each its gives. */
  joints: JointEntry[];
  /**
   * Error of positions in cross-validation, millimetres (RMS): that of geometry alone times the share that terms leave; absent if sizes
   * were given.
   */
  left_out_position_mm?: number | null;
  /** Frame of the measuring device. */
  measurement_frame: FrameEntry;
  /** Standard deviation of each component of the noise, millimetres or degrees, as the fit of screws and terms shows it. */
  noise: MeasuredOfNumber;
  /** Why these sizes. */
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
  /** Sizes that cross-validation tried; none if they were given. */
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
  /** The same of the axis' place; absent of a joint that slides. */
  shift_from_data?: number | null;
  /** Standard deviations of `axis` (root mean square); null where it is not determined. */
  sigma: AxisEntry;
  /** `sigma` if the axes of all other joints were known; absent where the axis was held. */
  sigma_alone?: AxisEntry | null;
  /** Why the joint is suspicious: a correction beyond those of the others, or residuals that follow its position. */
  suspicious?: string | null;
  /** The measurements' share in what is known of the direction, from 0 to 1; the rest is the tolerance's. Absent without a tolerance. */
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
  /** Number of pairs with a correlation of 0.95 and more, either way. */
  strong: number;
};

/** Cross-validation on the fitted rows. */
export type CrossValidationEntry = {
  /** The ends of each joint's range, files, and groups of equal `id`, each predicted by a fit without it. */
  blocked: LeftOutEntry[];
  /**
   * Those of their rows with a joint beyond the range of the rows by which they were predicted, by more than a tenth of it. Absent if there
   * are none.
   */
  outside?: LeftOutEntry | null;
  /** Random folds, all together. */
  random: LeftOutEntry;
};

/** What measurements say of a limit. */
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
  /** Its cause. */
  cause?: Cause;
  /** Description. */
  description: string;
  /** Number of independent directions. */
  directions?: number;
  /** The joints concerned. */
  joints: string[];
};

/** What one group of terms does at one joint. */
export type EffectEntry = {
  /** Largest deviation in the fitted rows, milliradians, of shift and runout millimetres; of a ratio the change each radian. */
  amplitude: number;
  /** Share of its prior variance that the measurements took away, 0 to 1. */
  determined_share: number;
  /** Distance by which it moves the target in the fitted rows, but for the mean of all (root mean square), millimetres. */
  effect_mm: number;
  /** Whether it is more than chance and the prior make. */
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

/** Something that happened during a session. */
export type Event = {
  /** The same after it; absent where it was not tried. */
  error_after_mm?: number | null;
  /** Error of the delivered model in cross-validation (RMS, millimetres, or degrees without positions) before the repair. */
  error_before_mm?: number | null;
  /** Where that is: its file and line. */
  from: string;
  /** Number of the first measurement after it, from 1; of wrong configurations the first of them. */
  from_row: number;
  /** What it is. */
  kind: EventKind;
  /** What was moved: the instrument, the target, the joint; empty without a name. */
  name: string;
  /** Errors of some rows in their order, by the models before and after the repair, millimetres or degrees; not of what was not repaired. */
  residuals?: Array<[number, number, number]>;
  /** Numbers of the measurements of wrong configurations. */
  rows?: number[];
  /** How far it turned, degrees. */
  size_deg?: number | null;
  /** How far, millimetres; of a drift from the first measurement to the last. */
  size_mm?: number | null;
  /** What it is taken as, or what to do, a sentence. */
  statement: string;
};

/** What happened. The words do not change between versions. */
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

/** Something else that is read in each configuration. */
export type FactorReading = {
  /** Name of its column. */
  name: string;
  /** Value at which its terms are zero. */
  reference: number;
};

/** A number of a camera or of a board that was found. */
export type FoundEntry = {
  /** Standard deviation of what was found, by the corners and what was known before. */
  deviation: number;
  /** As it was found. */
  found: number;
  /** As it was given. */
  given: number;
  /** What it is: `lens`, `board` or `markers`, then a name, and the number's own, as `lens.left.fx`. */
  name: string;
  /** Standard deviation of what was known before. */
  prior: number;
  /** Its unit, `px` or `mm`; empty of shares and of coefficients. */
  unit: string;
};

/** Frame of the measuring device. */
export type FrameEntry = {
  /** Pose of the device in the base. */
  base_from_device: PoseEntry;
  /** Whether the frame was unknown or the base. */
  known: FrameWord;
};

/** Knowledge of the device frame. */
export type FrameWord = "unknown" | "base";

/** Whether the delivered model predicts better than the nominal model: anywhere inside the sampled range, or on rows that judge it. */
export type Gain = "clear" | "unclear" | "loss";

/** Weights that a robot carries. How heavy they are is in the coefficients. */
export type GravityEntry = {
  /** Where weights are pulled, base frame. */
  direction: [number, number, number];
  /**
   * Longest lever of each joint, by which moments about it are divided: the path from joint to joint to the farthest weight. It follows
   * from the other entries; 0 of a joint that carries nothing.
   */
  joint_levers_m?: number[];
  /**
   * Of each joint, the masses that it carries times their longest levers, by which the moment of all masses is divided; of a joint that
   * slides the masses alone. It follows from the other entries; 0 of a joint that carries nothing.
   */
  joint_mass_levers_kg_m?: number[];
  /** Origin of each joint of the nominal model at zero joint values, about which moments are counted, base frame. */
  joint_origins_m: Array<[number, number, number]>;
  /** The weights; the term `sag1` is of the first. */
  weights: WeightEntry[];
};

/** Which unknowns the measurements determine. */
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
  /** The same of the model that is delivered. */
  after_px?: number | null;
  /** Column and row, from 0. */
  at: [number, number];
  /** Their root mean square distance from where the registered model sees them, pixels; null without any. */
  before_px?: number | null;
  /** Number of corners. */
  corners: number;
  /** Mean of measured minus predicted pixel by that model, along u and v. */
  mean_px?: [number, number] | null;
  /**
   * Root mean square distance by which a point before the middle of the cell is predicted off, by the covariance of robot, camera and
   * board; null beyond the lens.
   */
  predicted_px?: number | null;
};

/** Errors of corners over the image of a camera, and how well the calibration predicts pixels there. */
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

/** Root mean square error of the nominal model, registered, over that of another, on the same rows. */
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
  /** Of the calibrated model. */
  calibrated: MeasuredOfImprovement;
  /** Of the corrected model; absent if there is none. */
  corrected?: MeasuredOfImprovement | null;
};

/** A file as it was read. */
export type InputEntry = {
  /** Its name, as in `measurements`. */
  file: string;
  /** What the file is; absent of a table in our form. */
  form?: string | null;
  /** Lost beams: measurements without a position, which were left out. */
  lost?: number;
  /** Its rows, those of lost beams included. */
  rows: number;
  /** What was taken of it, a number for each quantity: `joint readings`, `points`, `poses` and other measurements. */
  taken: { [name: string]: number };
  /** What was understood of one in another form, in a few words: sheet, frame, body, topic, unit. */
  understood?: string | null;
  /** Units of its columns. */
  units?: string[];
};

/** Inputs. */
export type Inputs = {
  /** The command that reproduces the calibration; null if it was not made by the program. */
  command?: string | null;
  /** What each measurement file is and what was taken of it; one with joint readings and measurements has two entries. */
  files?: InputEntry[];
  /** How files of joint readings and of measurements were joined; absent if one file has both. */
  joins?: JoinEntry[];
  /** The measurement files, as named by the user. */
  measurements: string[];
  /** The robot model, as named by the user. */
  model: string;
  /** SHA-256 of each file by its name; of input that is no regular file, such as a pipe, only for measurements. */
  sha256?: { [name: string]: string };
  /** The URDF that was calibrated; absent if the model was none. */
  urdf?: OriginalUrdf | null;
};

/** An instrument on the robot. */
export type InstrumentEntry = {
  /** Body on which it stands. Its pose is in the frame of the joint that moves the body, or in the base. */
  on: BodyEntry;
  /** Position, metres. */
  position_m: [number, number, number];
  /** Unit quaternion x, y, z, w. */
  quaternion_xyzw: [number, number, number, number];
};

/** How the rows of a file of joint readings and of one of measurements find each other. */
export type Join = "name" | "rows" | "time" | "motion";

/** How a file of measurements was joined with one of joint readings. */
export type JoinEntry = {
  /** How rows found each other. */
  join: Join;
  /** Rows of joint readings, or stands of their stream. */
  joint_rows: number;
  /** The file of joint readings. */
  joints: string;
  /** Time of the measurements less that of the joint readings, seconds; absent without clocks. */
  lag_s?: number | null;
  /** The target's motion, of a stream of measurements, or of single points with times. */
  measured_motion?: MotionEntry | null;
  /** Configurations in which was measured, or stands of the stream of measurements. */
  measured_rows: number;
  /** The file of measurements. */
  measurements: string;
  /** By how much the nominal robot misses the pairs (median), millimetres; absent where they are too few to say. */
  missed_mm?: number | null;
  /** Number of pairs. */
  paired: number;
  /** Pairs: number of the row of joint readings, and of the measured configuration, each from 1; at most 2,000. */
  pairs: Array<[number, number]>;
  /** Joint readings at which more than once was measured. */
  repeated?: RowEntry[];
  /** The robot's motion, of a stream of joint readings. */
  robot_motion?: MotionEntry | null;
  /** Joint readings at which nothing was measured; at most 1,000, as of the next two. */
  unmeasured?: RowEntry[];
  /** Measured configurations that were left out: they have no joint readings. */
  unread?: RowEntry[];
};

/**
 * How a joint differs from the nominal one, in parts: a joint offset, and the tilt and shift of the axis that offsets and base do not
 * explain. Directions are those of the base frame with all joints at zero.
 */
export type JointChangeEntry = {
  /** The point of the axis for which the shift is stated: the nearest to the joint's origin, metres. */
  at_m: [number, number, number];
  /** What is to be added to the value of a joint that turns, degrees; null where base or tool can take its place. */
  offset_deg?: number | null;
  /** The same of a joint that slides, millimetres. */
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
   * Share of that range at its ends which at most a fiftieth of the rows reach, beyond a gap of more than 15 % of the range: it does not
   * count as sampled.
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
  /** The joint whose compliance this is: it turns by its terms alone, whose functions are of that joint. */
  compliance_of?: string | null;
  /** Kind. */
  kind: KindWord;
  /** Lower and upper limit, radians or metres. */
  limits?: [number, number] | null;
  /** Name. */
  name: string;
  /** Screw of the nominal model. */
  nominal_screw: ScrewEntry;
  /** The same of the nominal model. */
  nominal_terms?: { [name: string]: number };
  /** Body on which the joint stands, if that is not the link of the joint before. */
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
  /** By the calibrated model. */
  calibrated: number;
  /** By the corrected model. */
  corrected: number;
  /** From, radians or metres. */
  from: number;
  /** Number of rows. */
  rows: number;
  /** Its standard deviation. */
  sigma: number;
  /** Mean deviation by the joint's own terms. */
  terms: number;
  /** To. */
  to: number;
};

/** Error of a joint over its sampled range: the motion of the joint that explains most of the residuals there. */
export type JointErrorsEntry = {
  /** The joint. */
  joint: string;
  /** Parts of its range with rows enough. */
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

/** Level of a verdict: what the delivered model may be used for. */
export type Level = "do_not_use" | "located" | "measured_configurations" | "inside_sampled_range" | "good";

/**
 * Loss of robust estimation, a function of the length of a row's whitened residual. Its constant gives 95 % efficiency under normal noise
 * of that many components.
 */
export type Loss = "huber" | "cauchy" | "tukey";

/** A mass of the model. */
export type MassEntry = {
  /** How heavy it is, kg. */
  mass_kg: number;
  /** Its body. */
  on: BodyEntry;
  /** Its centre at zero joint values, base frame, metres. */
  place_m: [number, number, number];
};

/** What was measured of a target. */
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
  /** Of the corners of all pictures; absent if there are none. */
  pixels?: PixelAccuracy | null;
  position_mm?: Statistic;
  /**
   * Of all rows that a device without a frame of its own measured, millimetres, whatever their quantity: what their constraint leaves, as
   * the error of a distance, a ball from the middle of its socket, a height over its plane. Absent if there are none.
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
  /** Begin and end of the times without a row, as of lost frames, seconds; the longest 1,000. */
  gaps_s?: Array<[number, number]>;
  /** Its rows. */
  rows: number;
  /** Speed of the nominal robot's tip, or of the target that was seen most, over each step, mm/s; null where no row is near. */
  speeds_mm_s: Array<number | null>;
  /** Begin and end of each stand, seconds; both the same of a single point. */
  stands_s: Array<[number, number]>;
  /** Seconds from one speed to the next; zero without speeds. */
  step_s: number;
};

/** Noise by which residuals were weighted where a row stated none. */
export type NoiseEntry = {
  /** Standard deviation of each component of each measured quantity, millimetres or degrees. */
  sigma: MeasuredOfNumber;
  /** Source of the noise. */
  source: NoiseSource;
};

/** Source of the noise. */
export type NoiseSource = "given" | "rows" | "estimated" | "exact";

/**
 * The indices O1 to O5 of sun2008 over the singular values `s₁ ≥ … ≥ sₙ` of the whitened Jacobian of the scaled minimal unknowns: theory.md
 * §7 (36b). Larger is better. `None` where a singular value is zero but for rounding.
 */
export type Observability = {
  /** `(s₁ s₂ … sₙ)^(1/n) / √m`, 1/m (metre): the geometric mean of the singular values, by the number m of configurations. */
  o1?: number | null;
  /** `sₙ / s₁`: the inverse of the condition number. */
  o2?: number | null;
  /** `sₙ`, 1/m (metre): the inverse of the largest standard deviation. */
  o3?: number | null;
  /** `sₙ² / s₁`, 1/m (metre): how noise is amplified. */
  o4?: number | null;
  /** `1 / Σ 1/sₖ`, 1/m (metre). */
  o5?: number | null;
};

/** Offset of a joint. */
export type OffsetEntry = {
  /** The joint. */
  joint: string;
  /** Of a revolute joint, degrees. */
  offset_deg?: number | null;
  /** Of a prismatic joint, millimetres. */
  offset_mm?: number | null;
};

/**
 * The URDF that was calibrated, with what of it was: every form of the result that is a URDF is this text with other numbers, so that
 * meshes, comments and links outside the chain stay.
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
   * Distance from the position that the calibrated model predicts, angle from the orientation, and so on of each measured quantity,
   * millimetres or degrees.
   */
  residual: MeasuredOfNumber;
  /** Its line in that file, from 1. */
  row: number;
  /** Its set. */
  set: OutlierSet;
  /** Studentised residual: length over its own standard deviation. */
  studentized: number;
  /** Weight in the fit, 0 to 1; of a held-out row the weight that it would have had. */
  weight: number;
};

/** Set of a suspected row. */
export type OutlierSet = "fit" | "held_out";

/** The pictures of the session: their noise, and the lenses that they were read with. */
export type PicturesEntry = {
  /** The boards. */
  boards?: BoardEntry[];
  /** The cameras. */
  cameras: CameraEntry[];
  /** What the corners of a picture share: the error of the configuration. */
  common: CommonEntry;
  /** Number of corners in them. */
  corners: number;
  /** Number of pictures. */
  count: number;
  /**
   * Numbers of cameras and boards that were found with the robot (`--free lens`, `board`, `markers`), with what is above; absent if all
   * were given.
   */
  found?: FoundEntry[];
  /** Errors of corners over the image of each camera whose picture has a known size. */
  images?: ImageEntry[];
  /** Standard deviation of each coordinate of a corner that states none, pixels. */
  sigma_px: number;
  /** Those that lost their weight, since they do not fit the others of their picture. */
  without_weight: number;
};

/** Distances of corners from where a model sees them: in the picture, and at the board, square to the ray. */
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
  /** Root mean square over the corners at the board, square to the ray, millimetres. */
  rms_mm: number;
  /** Root mean square over the corners, pixels. */
  rms_px: number;
  /** Corners that the model has behind the camera or beyond its lens; they are in no figure. */
  unseen?: number;
};

/** A point of a body. */
export type PointEntry = {
  /** Its name. */
  name: string;
  /** Its place in the frame of the body, millimetres. */
  place_mm: [number, number, number];
};

/** Accuracy of each model in a pose, millimetres or degrees. */
export type PoseAccuracy = {
  /** Of the calibrated model. */
  calibrated: MeasuredOfNumber;
  /** Of the nominal model. */
  nominal: MeasuredOfNumber;
  /** Of the registered model. */
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
  /** From, radians or metres. */
  from: number;
  /** The joint. */
  joint: string;
  /** Root mean square distance, millimetres, with the other joints anywhere in their ranges. */
  sigma_position_mm: number;
  /** To. */
  to: number;
};

/** By how much a reading is corrected. */
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

/** A joint that was calibrated anew; all else is as the calibration before had it. */
export type RecalibratedEntry = {
  /** The calibration before. */
  calibration: string;
  /** The joint. */
  joint: string;
  /** The measurement files. */
  measurements: string[];
  /** By what motion of the base's axes the axis moved, and of a zero what follows the joint: metres and radians, linear part first. */
  motion: [number, number, number, number, number, number];
  /** What of it. */
  part: RepairedPart;
  /** The latter. */
  repeated: number;
  /** Number of measurements, and how many of them repeat configurations of earlier ones. */
  rows: number;
  /** SHA-256 of each, by name. */
  sha256: { [name: string]: string };
  /** Standard deviation of that. */
  sigma: number;
  /** What was added to its zero, degrees; of a joint that slides millimetres. Of an axis its turn, degrees. */
  size: number;
};

/** What is stated of a session, for its report: after ISO/IEC 17025:2017, 7.8.2. poecal computes nothing from it. */
export type Record = {
  /** Number of the report or certificate. */
  certificate?: string | null;
  /** For whom. */
  customer?: string | null;
  /** Day of the measurements, `YYYY-MM-DD`. */
  date?: string | null;
  /** The measuring instrument: its serial number and its own certificate. */
  instrument?: string | null;
  /** Day of the instrument's own calibration, `YYYY-MM-DD`. */
  instrument_calibrated?: string | null;
  /** Who calibrated: name and address. */
  laboratory?: string | null;
  /** Anything else. */
  note?: string | null;
  /** Who measured. */
  operator?: string | null;
  /** The load that the robot carried, with its unit. */
  payload?: string | null;
  /** Where the robot stood. */
  place?: string | null;
  /** The robot as its owner calls it: maker and type. */
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

/** What of a joint was calibrated anew. */
export type RepairedPart = "zero" | "axis";

/** Pose accuracy and repeatability of positions, after ISO 9283; of poses that were measured by other quantities theirs. */
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
  /** What else is read in each configuration and terms depend on; the term `factor1` is of the first. */
  factors?: FactorReading[];
  /** Weights that the robot carries, if its joints sag. */
  gravity?: GravityEntry | null;
  /** Masses of the model's links; the term `masses` is of all of them. */
  masses?: MassEntry[];
  /** Name. */
  name: string;
  /** The same of the nominal model. */
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
  suspected: BySet;
  /** `accuracy` without suspected rows; null of a set that has none. */
  without_suspected: BySet2;
};

/** A row of a file. */
export type RowEntry = {
  /** Its line, row of a sheet or message; of a stand that of its first row. */
  line: number;
  /** Its number among the rows or stands, from 1. */
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
  /** Screws and terms of the joints fitted together; absent if no terms were asked for. */
  corrected?: ModelAccuracy | null;
  /** Number of measurements. */
  count: number;
  /** How many times smaller than the registered model's the errors of rows held out are; absent of others. */
  improvement?: Improvements | null;
  /** The nominal model; only an unknown device frame is fitted. */
  nominal: ModelAccuracy;
  /** Device frame and targets fitted, screws nominal. */
  registered: ModelAccuracy;
};

/** Why a corrected model has terms of its sizes. */
export type SizesReason = "given" | "predict" | "no_better" | "small" | "too_few" | "undetermined" | "led_nowhere" | "worse_held_out";

/** The minimisation: steps, end, convergence. */
export type SolverEntry = {
  /** Tolerance of the prior, if cross-validation chose it. */
  chosen_tolerance?: ToleranceEntry | null;
  /** Whether an optimum was reached. */
  converged: boolean;
  /** Parameterisation of joint errors: `adjoint`, or a formulation for comparison. */
  formulation?: string;
  /** Iterations of the full fit. */
  iterations: number;
  /**
   * Joint offsets found: joint value minus reading, where the formulation has them. Data cannot separate them from screws; in `joints` they
   * are part of the screws, and the readings need no correction.
   */
  joint_offsets?: OffsetEntry[] | null;
  /** Method of the solver: `levenberg-marquardt`, or others for comparison. */
  method?: string;
  /** Effect of the formulation on the result, if it is not the usual one. */
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
   * What it is, if it is no instrument with a frame of its own: anchor, socket, plane (z is its normal), sphere, direction (z is along it),
   * pair (of configurations: its pose means nothing).
   */
  kind?: string | null;
  /** Radius of a sphere, with that of the probe, known or found, millimetres. */
  radius_mm?: number | null;
  /** Growth of its readings with the distance, less 1, if it is not 0. */
  scale?: number | null;
  /** Standard deviation of each component of its measurements that state none, if it differs from that of the first instrument. */
  sigma?: MeasuredOfNumber | null;
  /** Reading of its distances at its own place, millimetres, if it is not 0; of a sphere that is touched, minus its radius. */
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
 * A configuration in which every measured position is suspected, of two targets or more, and off by like distances: there the arm or its
 * readings are wrong, not a target.
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
  /** What was measured of such a target; the rest of its pose is the model's. */
  measured?: MeasuredEntry | null;
  /** Body of a target that is not in the tip frame: its pose is in the frame of the joint that moves the body, or in the base. */
  on?: BodyEntry | null;
  /** Position, metres. */
  position_m: [number, number, number];
  /** Unit quaternion x, y, z, w, where orientation was measured; of a target on a body of its own, always. */
  quaternion_xyzw?: [number, number, number, number] | null;
};

/** Why a minimisation ended: data, not an error string. */
export type Termination = "optimum" | "step_vanished" | "no_progress" | "iteration_limit" | "not_finite";

/** From where a third axis counts. */
export type ThirdAxisWord = "arm" | "level";

/** Tolerance of the prior: how far each axis may be from nominal, standard deviations. */
export type ToleranceEntry = {
  /** Of its direction, degrees. */
  angle_deg: number;
  /** Of its place, millimetres. */
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
  /** The same outside the sampled range; absent if no larger. */
  covariance_outside_m2?: number[] | null;
  /** Degrees of freedom of the variance of each quantity's residuals; absent where their noise is stated. */
  degrees_of_freedom?: { [name: string]: number };
  /** The same outside the sampled range; absent if no larger. */
  extrapolation?: number | null;
  /** Point of the device frame about which its unknowns turn, metres, where the frame is among them. */
  frame_about_m?: [number, number, number] | null;
  /** Errors of held-out rows compared with their predicted uncertainty; null without such rows. */
  held_out?: MeasuredOfKeptEntry | null;
  /** Factor of the covariance over that of independent residuals. */
  inflation: number;
  /** Correlation of residuals of consecutive rows; null if not significant. */
  lag_one_correlation?: number | null;
  /** Metres that a radian counts in the covariance. */
  length_m: number;
  /** In the measured configurations. */
  measured: ExpectedEntry;
  /** Model error: standard deviation of each component, millimetres or degrees; of positions, rotations and what else was measured. */
  model_error: MeasuredOfNumber;
  /** Measurement noise in the residuals: standard deviation of each component, millimetres or degrees. */
  noise: MeasuredOfNumber;
  /** By parts of each joint's range. */
  parts: RangeEntry[];
  /** Anywhere within the limits. */
  range: ExpectedEntry;
  /** Whether the residuals of each quantity count as the robot's or the instrument's. */
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
 * A level, and the reasons against a better one; for the best level, the reasons for it. And the expected errors of the model that is
 * delivered.
 */
export type Verdict = {
  /** Mean of the distances that 95 % of its errors do not exceed there, millimetres. */
  bound95_mm?: number | null;
  /** That the axes of the nominal model are confirmed, a sentence with its figures: the fitted ones are the same within their uncertainty. */
  confirmed?: string | null;
  /**
   * Expected error of its predictions in configurations like those that were measured, millimetres (RMS); absent where no use is advised,
   * or nothing is known.
   */
  expected_error_mm?: number | null;
  /** Whether it predicts better than the nominal model there. */
  gain?: Gain | null;
  /** How far it may be used. */
  level: Level;
  /** The model that is delivered: the corrected one where it has terms. Missing in older files. */
  model?: AcceptedModel | null;
  /** Distance of the nominal model's predictions from its own there, with targets and devices fitted, millimetres (RMS). */
  nominal_error_mm?: number | null;
  /** Sentences with the deciding figures. */
  reasons: string[];
  /**
   * Expected error of its predictions anywhere inside the sampled range of each joint, millimetres (RMS); absent where no use is advised,
   * and in older files.
   */
  sampled_range_error_mm?: number | null;
};

/** A weight. */
export type WeightEntry = {
  /** What it is at: the name of a joint, or of the tip. */
  at: string;
  /** Its body. */
  on: BodyEntry;
  /** Its place at zero joint values, base frame. */
  place_m: [number, number, number];
};

/** A part of the workspace: a ring about the axis, as wide and as high as a cell. */
export type WorkspaceCellEntry = {
  /** Number of configurations. */
  configurations: number;
  /** Its height along the axis above the base's origin, from, metres. */
  height_m: number;
  /** Distances, millimetres. */
  position_mm: SpreadEntry;
  /** Distance of the nominal tip from the axis, from, metres. */
  radius_m: number;
  /** Angles, degrees. */
  rotation_deg: SpreadEntry;
  /**
   * Expected error of predicted positions in these configurations (root mean square, millimetres): what a corrected program is expected to
   * miss by. Missing without an uncertainty, and in files of earlier versions.
   */
  sigma_position_mm?: number | null;
};
