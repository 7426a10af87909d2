//! Tables of poses to fill.

/// A table of poses to fill: of arm and target side by side, or of the arm's touches of a point.
#[must_use]
pub fn pose_table(has_target: bool) -> String {
    let flange = "flange_x[mm],flange_y[mm],flange_z[mm],flange_A[deg],flange_B[deg],flange_C[deg]";
    let forms = "# A, B, C are KUKA's; instead: W, P, R (FANUC), rx, ry, rz in [rad] (Universal Robots), q1 to q4 (ABB), qx, qy, qz, qw (ROS), r11 to r33\n";
    if has_target {
        let target = "target_rvec_x,target_rvec_y,target_rvec_z,target_tvec_x[mm],target_tvec_y[mm],target_tvec_z[mm]";
        format!(
            "# A row for each pose: the flange in the base as the controller shows it, and the target as the camera sees it; 15 to 30 poses, turned by 20 deg \
             and more about two axes\n{forms}image,{flange},{target}\n"
        )
    } else {
        format!(
            "# A row for each touch of a fixed point by the tip: the flange in the base, with the controller's tool set to zero; 6 to 10 touches, tilted by \
             20 deg and more to all sides\n# point: name of the point, if there are several; tip: two tips along the tool show its direction\n{forms}{flange},point,tip\n"
        )
    }
}
