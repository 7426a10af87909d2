// The calibration by Ceres, with a Jacobian written by hand and a dense solver.
//
//   ceres_peer FOLDER pose|point SOLVER             one fit, repeated for its time
//   ceres_peer FOLDER monte_carlo SOLVER FITS       FITS fits of poses of exact.txt, each with new noise
//
// SOLVER is `cholesky` or `qr`, or `tuned`: cholesky with hardly any damping at the start, which these problems do not need.
// Prints a line of JSON. Unknowns: four numbers a joint (its axis shifted along and tilted about the two directions across it),
// then the tool's shift, and with poses its rotation. The measured rotation is compared by the logarithm; the derivative of that
// is taken as -1, which leaves the gradient exact (docs/theory.md, section 4).
#include <ceres/ceres.h>
#include <algorithm>
#include <ctime>
#include <random>

#include "problem.h"

constexpr size_t kMostJoints = 64;
constexpr double kTolerance = 1e-10;
constexpr double kTunedRadius = 1e8;  // of the first trust region; 1e4 if nothing is said
constexpr double kLongEnough = 0.3, kTooLong = 2.0;  // seconds for which a fit is repeated
constexpr size_t kFewestRepeats = 3;

double cpu_seconds() {
  timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return time.tv_sec + 1e-9 * time.tv_nsec;
}

// The robot at some values of the unknowns, worked out once for all rows.
struct Candidate {
  struct Joint {
    Vector3d point, direction;
    Vector3d tilt_x, tilt_y;  // how the axis turns by a change of each tilt
  };
  std::vector<Joint> joints;
  Vector3d tool;               // in the frame of the last joint
  Matrix3d tool_rotation;
  Matrix3d tool_turn;          // how the tool turns by a change of its rotation's numbers
};

size_t unknowns(const Robot& robot, bool poses) { return 4 * robot.axes.size() + (poses ? 6 : 3); }

Candidate candidate(const Robot& robot, const double* x, bool poses) {
  Candidate made;
  for (const Axis& axis : robot.axes) {
    const Vector3d tilt = axis.x * x[2] + axis.y * x[3];
    const Matrix3d turn = left_jacobian(tilt);
    made.joints.push_back(
        {axis.point + axis.x * x[0] + axis.y * x[1], exp_so3(tilt) * axis.z, turn * axis.x, turn * axis.y});
    x += 4;
  }
  made.tool = robot.home.position + robot.home.rotation * Vector3d(x[0], x[1], x[2]);
  const Vector3d rotation = poses ? Vector3d(x[3], x[4], x[5]) : Vector3d::Zero();
  made.tool_rotation = robot.home.rotation * exp_so3(rotation);
  made.tool_turn = robot.home.rotation * left_jacobian(rotation);
  return made;
}

// Works out the candidate once for each point that Ceres looks at, instead of once a row.
struct Shared : ceres::EvaluationCallback {
  const Robot& robot;
  const std::vector<double>& x;
  bool poses;
  Candidate now;
  Shared(const Robot& robot, const std::vector<double>& x, bool poses) : robot(robot), x(x), poses(poses) {}
  void PrepareForEvaluation(bool, bool new_point) override {
    if (new_point || now.joints.empty()) now = candidate(robot, x.data(), poses);
  }
};

// Sine and 1 - cosine of readings, one after the other: they stay the same throughout a fit.
std::vector<double> turns_of(const std::vector<double>& readings) {
  std::vector<double> turns;
  turns.reserve(2 * readings.size());
  for (double reading : readings) turns.push_back(std::sin(reading)), turns.push_back(1 - std::cos(reading));
  return turns;
}

// The chain of a row: the rotation before each joint and after the last, and where each axis' point is.
struct Chain {
  Matrix3d before[kMostJoints + 1];
  Vector3d point[kMostJoints];
  Vector3d position;

  Chain(const Candidate& robot, const double* turns) {
    const size_t joints = robot.joints.size();
    Matrix3d rotation = Matrix3d::Identity();
    Vector3d origin = Vector3d::Zero();
    for (size_t i = 0; i < joints; ++i) {
      const Candidate::Joint& joint = robot.joints[i];
      const Matrix3d across = skew(joint.direction);
      before[i] = rotation;
      point[i] = origin + rotation * joint.point;
      rotation = rotation + rotation * (turns[2 * i] * across + turns[2 * i + 1] * (across * across));
      origin = point[i] - rotation * joint.point;
    }
    before[joints] = rotation;
    position = origin + rotation * robot.tool;
  }
};

// A measured pose or point, whitened.
class Row : public ceres::CostFunction {
 public:
  Row(const Robot& robot, const Shared& shared, const double* turns, const Pose& measured)
      : robot_(robot), shared_(shared), turns_(turns), measured_(measured) {
    set_num_residuals(shared.poses ? 6 : 3);
    mutable_parameter_block_sizes()->push_back(unknowns(robot, shared.poses));
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    const Candidate& now = shared_.now;
    const Chain chain(now, turns_);
    const Matrix3d& last = chain.before[now.joints.size()];
    Eigen::Map<Eigen::VectorXd> whitened(residuals, num_residuals());
    whitened.head<3>() = (measured_.position - chain.position) / robot_.sigma_position;
    if (shared_.poses) {
      const Matrix3d predicted = last * now.tool_rotation;
      whitened.tail<3>() = log_so3(measured_.rotation * predicted.transpose()) / robot_.sigma_rotation;
    }
    if (jacobians && jacobians[0]) {
      if (shared_.poses)
        derivatives<6>(chain, jacobians[0]);
      else
        derivatives<3>(chain, jacobians[0]);
    }
    return true;
  }

 private:
  template <int Rows>
  void derivatives(const Chain& chain, double* out) const {
    const Candidate& now = shared_.now;
    const size_t joints = now.joints.size();
    const double by_position = -1 / robot_.sigma_position, by_rotation = -1 / robot_.sigma_rotation;
    Eigen::Map<Eigen::Matrix<double, Rows, Eigen::Dynamic, Eigen::RowMajor>> jacobian(out, Rows, 4 * joints + Rows);
    for (size_t i = 0; i < joints; ++i) {
      // What stands before the joint moves with the axis, what stands after it moves against it.
      const Matrix3d difference = chain.before[i] - chain.before[i + 1];
      const Vector3d arm = chain.position - chain.point[i];
      const Vector3d tilts[2] = {difference * now.joints[i].tilt_x, difference * now.joints[i].tilt_y};
      const Vector3d* shifts[2] = {&robot_.axes[i].x, &robot_.axes[i].y};
      for (int k = 0; k < 2; ++k) {
        const size_t shift = 4 * i + k, tilt = shift + 2;
        jacobian.col(shift).template head<3>() = by_position * (difference * *shifts[k]);
        jacobian.col(tilt).template head<3>() = by_position * tilts[k].cross(arm);
        if constexpr (Rows == 6) {
          jacobian.col(shift).template tail<3>().setZero();
          jacobian.col(tilt).template tail<3>() = by_rotation * tilts[k];
        }
      }
    }
    const Matrix3d& last = chain.before[joints];
    jacobian.template block<3, 3>(0, 4 * joints) = by_position * (last * robot_.home.rotation);
    if constexpr (Rows == 6) {
      jacobian.template block<3, 3>(0, 4 * joints + 3).setZero();
      jacobian.template block<3, 3>(3, 4 * joints).setZero();
      jacobian.template block<3, 3>(3, 4 * joints + 3) = by_rotation * (last * now.tool_turn);
    }
  }

  const Robot& robot_;
  const Shared& shared_;
  const double* turns_;
  const Pose& measured_;
};

struct Fit {
  std::vector<double> x;
  int iterations;
};

// Builds the problem and solves it from the nominal robot.
Fit fit(const Robot& robot, const Measurements& data, bool poses, const std::string& solver) {
  Fit fit{std::vector<double>(unknowns(robot, poses), 0.0), 0};
  const std::vector<double> turns = turns_of(data.readings);
  const size_t joints = robot.axes.size();
  Shared shared(robot, fit.x, poses);
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &shared;
  ceres::Problem problem(problem_options);
  for (size_t row = 0; row < data.rows(); ++row)
    problem.AddResidualBlock(new Row(robot, shared, &turns[row * 2 * joints], data.poses[row]), nullptr, fit.x.data());
  ceres::Solver::Options options;
  options.linear_solver_type = solver == "qr" ? ceres::DENSE_QR : ceres::DENSE_NORMAL_CHOLESKY;
  if (solver == "tuned") options.initial_trust_region_radius = kTunedRadius;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = kTolerance;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  // The first "step" of Ceres is the evaluation at the start.
  fit.iterations = summary.num_successful_steps + summary.num_unsuccessful_steps - 1;
  return fit;
}

// Mean square distance of predicted and true position.
double mean_square_m2(const Robot& robot, const Fit& fit, const Measurements& held_out, bool poses) {
  const Candidate now = candidate(robot, fit.x.data(), poses);
  const std::vector<double> turns = turns_of(held_out.readings);
  const size_t joints = robot.axes.size();
  double sum = 0;
  for (size_t row = 0; row < held_out.rows(); ++row) {
    const Chain chain(now, &turns[row * 2 * joints]);
    sum += (chain.position - held_out.poses[row].position).squaredNorm();
  }
  return sum / held_out.rows();
}

void print(double cpu_ms, double iterations, double held_out_mm) {
  std::cout.precision(9);
  std::cout << "{\"cpu_ms\": " << cpu_ms << ", \"iterations\": " << iterations << ", \"held_out_mm\": " << held_out_mm << "}\n";
}

void one_fit(const Robot& robot, const Measurements& data, const Measurements& held_out, bool poses,
             const std::string& solver) {
  Fit last;
  std::vector<double> times;
  double total = 0;
  while (times.empty() || (total < kTooLong && (total < kLongEnough || times.size() < kFewestRepeats))) {
    const double start = cpu_seconds();
    last = fit(robot, data, poses, solver);
    times.push_back(cpu_seconds() - start);
    total += times.back();
  }
  std::sort(times.begin(), times.end());
  print(1e3 * times[times.size() / 2], last.iterations, 1e3 * std::sqrt(mean_square_m2(robot, last, held_out, poses)));
}

void monte_carlo(const Robot& robot, const Measurements& exact, const Measurements& held_out,
                 const std::string& solver, size_t fits) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  auto draw = [&](double sigma) { return Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random)); };
  double seconds = 0, iterations = 0, sum = 0;
  for (size_t i = 0; i < fits; ++i) {
    Measurements noisy = exact;
    for (Pose& pose : noisy.poses) {
      pose.position += draw(robot.sigma_position);
      pose.rotation = exp_so3(draw(robot.sigma_rotation)) * pose.rotation;
    }
    const double start = cpu_seconds();
    const Fit fitted = fit(robot, noisy, true, solver);
    seconds += cpu_seconds() - start;
    iterations += fitted.iterations;
    sum += mean_square_m2(robot, fitted, held_out, true);
  }
  print(1e3 * seconds, iterations / fits, 1e3 * std::sqrt(sum / fits));
}

int main(int count, char** words) {
  const std::vector<std::string> arguments(words + 1, words + count);
  if (arguments.size() < 3) fail("usage: ceres_peer FOLDER pose|point|monte_carlo cholesky|qr|tuned [FITS]");
  const std::string folder = arguments[0] + "/";
  const bool monte = arguments[1] == "monte_carlo", poses = arguments[1] != "point";
  const Robot robot = read_robot(folder + "robot.txt");
  const size_t joints = robot.axes.size();
  if (joints > kMostJoints) fail("the robot has more than " + std::to_string(kMostJoints) + " joints");
  const std::string& solver = arguments[2];
  const Measurements held_out = read_measurements(folder + "held_out.txt", joints, poses);
  const Measurements data = read_measurements(folder + (monte ? "exact.txt" : "measurements.txt"), joints, poses);
  if (monte)
    monte_carlo(robot, data, held_out, solver, arguments.size() > 3 ? std::stoul(arguments[3]) : 1000);
  else
    one_fit(robot, data, held_out, poses, solver);
}
