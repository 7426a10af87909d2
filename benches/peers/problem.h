// What a peer is given: a nominal robot and measurements, as the plain numbers that problems.py writes. Metres and radians.
#pragma once
#include <Eigen/Dense>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Pose {
  Matrix3d rotation;
  Vector3d position;
};

// A revolute axis at zero joint value: a point on it, its direction `z`, and two directions across it.
struct Axis {
  Vector3d point, x, y, z;
};

struct Robot {
  std::vector<Axis> axes;
  Pose home;
  double sigma_position, sigma_rotation;
};

// Joint readings, one row after the other, and what was measured. Points have identity for a rotation.
struct Measurements {
  std::vector<double> readings;
  std::vector<Pose> poses;
  size_t rows() const { return poses.size(); }
};

[[noreturn]] inline void fail(const std::string& message) {
  std::cerr << message << "\n";
  std::exit(2);
}

inline Matrix3d skew(const Vector3d& a) {
  return (Matrix3d() << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0).finished();
}

// Rotation by the vector `a`.
inline Matrix3d exp_so3(const Vector3d& a) {
  const double angle = a.norm();
  if (angle < 1e-12) return Matrix3d::Identity() + skew(a);
  return Eigen::AngleAxisd(angle, a / angle).toRotationMatrix();
}

// The vector of a rotation, below half a turn.
inline Vector3d log_so3(const Matrix3d& r) {
  const Vector3d v = 0.5 * Vector3d(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
  const double sine = v.norm(), cosine = 0.5 * (r.trace() - 1);
  return sine < 1e-9 ? v : Vector3d(v * (std::atan2(sine, cosine) / sine));
}

// J of exp(a + da) = exp(J da) exp(a).
inline Matrix3d left_jacobian(const Vector3d& a) {
  const double angle2 = a.squaredNorm(), angle = std::sqrt(angle2);
  const bool small = angle < 1e-4;
  const double b = small ? 0.5 - angle2 / 24 : (1 - std::cos(angle)) / angle2;
  const double c = small ? 1.0 / 6 - angle2 / 120 : (angle - std::sin(angle)) / (angle2 * angle);
  return Matrix3d::Identity() + b * skew(a) + c * skew(a) * skew(a);
}

inline Axis axis_of_screw(const Vector3d& v, const Vector3d& w) {
  const Vector3d aside = std::abs(w.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
  const Vector3d x = (aside - w * w.dot(aside)).normalized();
  return {w.cross(v), x, w.cross(x), w};
}

inline Pose pose_of(const double* numbers, bool with_rotation) {
  Pose pose{Matrix3d::Identity(), Vector3d(numbers[0], numbers[1], numbers[2])};
  if (with_rotation)
    pose.rotation = Eigen::Quaterniond(numbers[6], numbers[3], numbers[4], numbers[5]).normalized().toRotationMatrix();
  return pose;
}

// Lines `joint vx vy vz wx wy wz` from base to tip, `home x y z qx qy qz qw` and `noise POSITION ROTATION`.
inline Robot read_robot(const std::string& path) {
  std::ifstream file(path);
  Robot robot;
  std::string word;
  while (file >> word) {
    std::vector<double> numbers(word == "joint" ? 6 : word == "home" ? 7 : 2);
    for (double& number : numbers) file >> number;
    const double* at = numbers.data();
    if (word == "joint") robot.axes.push_back(axis_of_screw({at[0], at[1], at[2]}, {at[3], at[4], at[5]}));
    if (word == "home") robot.home = pose_of(at, true);
    if (word == "noise") robot.sigma_position = at[0], robot.sigma_rotation = at[1];
  }
  if (robot.axes.empty()) fail(path + ": found no joints");
  return robot;
}

// Rows of the readings and `x y z`, with poses `qx qy qz qw` too.
inline Measurements read_measurements(const std::string& path, size_t joints, bool poses) {
  std::ifstream file(path);
  Measurements read;
  const size_t columns = joints + (poses ? 7 : 3);
  std::vector<double> row;
  double number;
  while (file >> number) {
    row.push_back(number);
    if (row.size() < columns) continue;
    read.readings.insert(read.readings.end(), row.begin(), row.begin() + joints);
    read.poses.push_back(pose_of(row.data() + joints, poses));
    row.clear();
  }
  if (read.poses.empty() || !row.empty()) fail(path + ": expected rows of " + std::to_string(columns) + " numbers");
  return read;
}
