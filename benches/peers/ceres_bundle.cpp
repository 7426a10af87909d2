// A bundle of pictures by Ceres, with a Jacobian written by hand.
//
//   ceres_bundle PROBLEM.txt SOLVER       the problem as crates/poecal/benches/bundle.rs writes it
//
// SOLVER is `dense_schur`, `sparse_schur`, `sparse_cholesky` or `dense_cholesky`. Prints a line of JSON. Unknowns: four numbers a joint (its
// axis tilted about and shifted along the two directions across it), six of the base in the board's frame and six of the camera on the arm; nine of
// the lens and three of each point, with their priors, unless they are known. What depends on the picture alone is worked out once a
// picture, before each evaluation.
#include <ceres/ceres.h>
#include <algorithm>
#include <cstring>
#include <ctime>
#include <memory>

#include "problem.h"

constexpr int kJoints = 7, kMotion = 4 * kJoints + 12, kLens = 9;
constexpr double kTolerance = 1e-9, kLongEnough = 0.5;

using Row = Eigen::Matrix<double, 6, kMotion, Eigen::RowMajor>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

double cpu_seconds() {
  timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return time.tv_sec + 1e-9 * time.tv_nsec;
}

struct Problem {
  std::vector<Pose> axes;
  Pose board_from_base, base_from_camera;
  std::vector<double> lens, lens_prior, points;
  double point_prior, sigma;
  std::vector<double> readings, pixels;
  size_t corners, pictures;
};

Pose times(const Pose& a, const Pose& b) { return {a.rotation * b.rotation, a.rotation * b.position + a.position}; }

// A twist seen from another frame.
Vector6 moved(const Pose& pose, const Vector6& twist) {
  Vector6 out;
  out.tail<3>() = pose.rotation * twist.tail<3>();
  out.head<3>() = pose.rotation * twist.head<3>() + pose.position.cross(out.tail<3>());
  return out;
}

Pose exp_pose(const double* x) {
  return {exp_so3(Vector3d(x[3], x[4], x[5])), Vector3d(x[0], x[1], x[2])};
}

// Pose and its change with the motion's unknowns of each picture, at the values that Ceres looks at.
struct Arms : ceres::EvaluationCallback {
  const Problem& problem;
  const double* x;
  std::vector<Pose> camera_from_board;
  std::vector<Row> rows;
  Arms(const Problem& problem, const double* x)
      : problem(problem), x(x), camera_from_board(problem.pictures), rows(problem.pictures) {}

  void PrepareForEvaluation(bool with_jacobians, bool is_new) override {
    if (!is_new && !with_jacobians) return;
    Vector3d point[kJoints], direction[kJoints];
    Vector6 change[4 * kJoints];
    for (int i = 0; i < kJoints; i++) {
      const double* u = x + 4 * i;
      const Matrix3d& r = problem.axes[i].rotation;
      const Vector3d tilt = r.col(0) * u[0] + r.col(1) * u[1];
      const Matrix3d jacobian = left_jacobian(tilt);
      direction[i] = exp_so3(tilt) * r.col(2);
      point[i] = problem.axes[i].position + r.col(0) * u[2] + r.col(1) * u[3];
      for (int k = 0; k < 2; k++) {
        const Vector3d turn = jacobian * r.col(k);
        change[4 * i + k] << -turn.cross(point[i]), turn;
        change[4 * i + 2 + k] << r.col(k), Vector3d::Zero();
      }
    }
    const double* base = x + 4 * kJoints;
    const double* tool = base + 6;
    // The tool's numbers shift it in its own frame and turn it there.
    const Pose first = times(problem.board_from_base, exp_pose(base));
    const Pose last = times(problem.base_from_camera, exp_pose(tool));
    const Matrix3d base_turn = left_jacobian(Vector3d(base[3], base[4], base[5]));
    const Matrix3d tool_turn = left_jacobian(Vector3d(tool[3], tool[4], tool[5]));
    for (size_t p = 0; p < problem.pictures; p++) {
      Pose pose = first;
      Row row;
      for (int k = 0; k < 3; k++) {
        Vector6 shift, turn;
        shift << problem.board_from_base.rotation.col(k), Vector3d::Zero();
        const Vector3d axis = problem.board_from_base.rotation * base_turn.col(k);
        turn << -axis.cross(first.position), axis;
        row.col(4 * kJoints + k) = shift;
        row.col(4 * kJoints + 3 + k) = turn;
      }
      for (int i = 0; i < kJoints; i++) {
        const Matrix3d turned = exp_so3(direction[i] * problem.readings[p * kJoints + i]);
        const Pose joint = {turned, point[i] - turned * point[i]};
        const Pose next = times(pose, joint);
        if (with_jacobians)
          for (int k = 0; k < 4; k++)
            row.col(4 * i + k) = moved(pose, change[4 * i + k]) - moved(next, change[4 * i + k]);
        pose = next;
      }
      const Pose board_from_camera = times(pose, last);
      for (int k = 0; k < 3; k++) {
        Vector6 shift, turn;
        shift << pose.rotation * problem.base_from_camera.rotation.col(k), Vector3d::Zero();
        const Vector3d axis = pose.rotation * problem.base_from_camera.rotation * tool_turn.col(k);
        turn << -axis.cross(board_from_camera.position), axis;
        row.col(4 * kJoints + 6 + k) = shift;
        row.col(4 * kJoints + 9 + k) = turn;
      }
      const Matrix3d back = board_from_camera.rotation.transpose();
      camera_from_board[p] = {back, -back * board_from_camera.position};
      // The board in the camera's frame moves by the opposite, as a twist about the camera.
      if (with_jacobians)
        for (int k = 0; k < kMotion; k++) rows[p].col(k) = -moved(camera_from_board[p], row.col(k));
    }
  }
};

struct Corner : ceres::SizedCostFunction<2, kMotion, kLens, 3> {
  const Arms& arms;
  size_t picture;
  const double* pixel;
  double weight;
  Corner(const Arms& arms, size_t picture, const double* pixel, double weight)
      : arms(arms), picture(picture), pixel(pixel), weight(weight) {}

  bool Evaluate(double const* const* q, double* residual, double** jacobian) const override {
    const double *lens = q[1], *X = q[2];
    const Pose& pose = arms.camera_from_board[picture];
    const Vector3d point = pose.rotation * Vector3d(X[0], X[1], X[2]) + pose.position;
    const double w = 1 / point.z(), a = point.x() * w, b = point.y() * w, s = a * a + b * b;
    const double fx = lens[0], fy = lens[1], k1 = lens[4], k2 = lens[5], p1 = lens[6], p2 = lens[7], k3 = lens[8];
    const double radial = 1 + s * (k1 + s * (k2 + s * k3)), slope = k1 + s * (2 * k2 + 3 * k3 * s);
    const double x = a * radial + 2 * p1 * a * b + p2 * (s + 2 * a * a);
    const double y = b * radial + p1 * (s + 2 * b * b) + 2 * p2 * a * b;
    residual[0] = weight * (fx * x + lens[2] - pixel[0]);
    residual[1] = weight * (fy * y + lens[3] - pixel[1]);
    if (!jacobian) return true;
    const double j00 = radial + 2 * a * a * slope + 2 * p1 * b + 6 * p2 * a;
    const double j01 = 2 * a * b * slope + 2 * p1 * a + 2 * p2 * b;
    const double j11 = radial + 2 * b * b * slope + 6 * p1 * b + 2 * p2 * a;
    const double u = weight * fx * w, v = weight * fy * w;
    const double by_point[2][3] = {{u * j00, u * j01, -u * (j00 * a + j01 * b)}, {v * j01, v * j11, -v * (j01 * a + j11 * b)}};
    if (jacobian[0]) {
      const Row& row = arms.rows[picture];
      for (int i = 0; i < 2; i++) {
        const double* d = by_point[i];
        // By a turn about the camera: point x derivative.
        const double turn[3] = {point.y() * d[2] - point.z() * d[1], point.z() * d[0] - point.x() * d[2], point.x() * d[1] - point.y() * d[0]};
        double* out = jacobian[0] + i * kMotion;
        for (int k = 0; k < kMotion; k++)
          out[k] = d[0] * row(0, k) + d[1] * row(1, k) + d[2] * row(2, k) + turn[0] * row(3, k) + turn[1] * row(4, k) + turn[2] * row(5, k);
      }
    }
    if (jacobian[1]) {
      const double s2 = s * s, s3 = s2 * s, x_ = weight * fx, y_ = weight * fy;
      const double all[2 * kLens] = {weight * x, 0, weight, 0, x_ * a * s, x_ * a * s2, x_ * 2 * a * b, x_ * (s + 2 * a * a), x_ * a * s3,
                                     0, weight * y, 0, weight, y_ * b * s, y_ * b * s2, y_ * (s + 2 * b * b), y_ * 2 * a * b, y_ * b * s3};
      std::memcpy(jacobian[1], all, sizeof all);
    }
    if (jacobian[2])
      for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
          jacobian[2][3 * i + k] = by_point[i][0] * pose.rotation(0, k) + by_point[i][1] * pose.rotation(1, k) + by_point[i][2] * pose.rotation(2, k);
    return true;
  }
};

template <int N>
struct Prior : ceres::SizedCostFunction<N, N> {
  std::vector<double> given, sigma;
  Prior(std::vector<double> given, std::vector<double> sigma) : given(given), sigma(sigma) {}
  bool Evaluate(double const* const* q, double* residual, double** jacobian) const override {
    for (int i = 0; i < N; i++) residual[i] = (q[0][i] - given[i]) / sigma[i];
    if (jacobian && jacobian[0])
      for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) jacobian[0][i * N + k] = i == k ? 1 / sigma[i] : 0;
    return true;
  }
};

Problem read(const char* path) {
  std::ifstream in(path);
  if (!in) fail(std::string(path) + ": cannot be read");
  Problem p;
  auto numbers = [&](size_t count) {
    std::vector<double> all(count);
    for (double& value : all) in >> value;
    return all;
  };
  auto pose = [&] {
    const std::vector<double> v = numbers(12);
    Pose out;
    for (int i = 0; i < 3; i++) {
      for (int k = 0; k < 3; k++) out.rotation(i, k) = v[4 * i + k];
      out.position[i] = v[4 * i + 3];
    }
    return out;
  };
  const std::vector<double> counts = numbers(3);
  if (counts[0] != kJoints) fail("expected an arm of seven joints");
  p.corners = size_t(counts[1]), p.pictures = size_t(counts[2]);
  for (int i = 0; i < kJoints; i++) p.axes.push_back(pose());
  p.board_from_base = pose(), p.base_from_camera = pose();
  p.lens = numbers(kLens), p.lens_prior = numbers(kLens), p.points = numbers(3 * p.corners);
  const std::vector<double> sigmas = numbers(2);
  p.point_prior = sigmas[0], p.sigma = sigmas[1];
  for (size_t i = 0; i < p.pictures; i++) {
    for (double value : numbers(kJoints)) p.readings.push_back(value);
    for (double value : numbers(2 * p.corners)) p.pixels.push_back(value);
  }
  if (!in) fail(std::string(path) + ": found too few numbers");
  return p;
}

struct Result {
  double seconds, cost;
  size_t iterations;
};

Result solve(const Problem& problem, const std::string& solver) {
  const double begin = cpu_seconds();
  std::vector<double> motion(kMotion, 0), lens = problem.lens, points = problem.points;
  const bool is_free = problem.point_prior > 0;
  Arms arms(problem, motion.data());
  ceres::Problem::Options own;
  own.evaluation_callback = &arms;
  ceres::Problem ceres_problem(own);
  for (size_t p = 0; p < problem.pictures; p++)
    for (size_t k = 0; k < problem.corners; k++)
      ceres_problem.AddResidualBlock(new Corner(arms, p, &problem.pixels[2 * (p * problem.corners + k)], 1 / problem.sigma),
                                     nullptr, motion.data(), lens.data(), &points[3 * k]);
  if (is_free) ceres_problem.AddResidualBlock(new Prior<kLens>(problem.lens, problem.lens_prior), nullptr, lens.data());
  else ceres_problem.SetParameterBlockConstant(lens.data());
  for (size_t k = 0; k < problem.corners; k++) {
    double* point = &points[3 * k];
    if (is_free) ceres_problem.AddResidualBlock(new Prior<3>({point[0], point[1], point[2]}, std::vector<double>(3, problem.point_prior)), nullptr, point);
    else ceres_problem.SetParameterBlockConstant(point);
  }
  ceres::Solver::Options options;
  options.num_threads = 1;
  options.function_tolerance = kTolerance;
  options.max_num_iterations = 50;
  options.initial_trust_region_radius = 1e8;  // the start is good, and 1e4 costs further iterations
  if (is_free) {
    auto order = std::make_shared<ceres::ParameterBlockOrdering>();
    for (size_t k = 0; k < problem.corners; k++) order->AddElementToGroup(&points[3 * k], 0);
    order->AddElementToGroup(motion.data(), 1);
    order->AddElementToGroup(lens.data(), 1);
    options.linear_solver_ordering = order;
  }
  if (solver == "dense_schur") options.linear_solver_type = ceres::DENSE_SCHUR;
  else if (solver == "sparse_schur") options.linear_solver_type = ceres::SPARSE_SCHUR;
  else if (solver == "sparse_cholesky") options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  else if (solver == "dense_cholesky") options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  else fail("expected dense_schur, sparse_schur, sparse_cholesky or dense_cholesky");
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  return {cpu_seconds() - begin, summary.final_cost, summary.iterations.size()};
}

int main(int count, char** words) {
  if (count != 3) fail("expected PROBLEM.txt SOLVER");
  const Problem problem = read(words[1]);
  std::vector<double> times;
  Result result;
  double sum = 0;
  while (times.size() < 3 || sum < kLongEnough) {
    result = solve(problem, words[2]);
    times.push_back(1e3 * result.seconds);
    sum += result.seconds;
  }
  std::sort(times.begin(), times.end());
  std::cout.precision(17);
  std::cout << "{\"cpu_ms\": " << times[times.size() / 2] << ", \"iterations\": " << result.iterations << ", \"cost\": " << result.cost << "}\n";
}
