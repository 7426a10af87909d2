// Kinematics of calibrated robot arms. Made from crates/poecal-c by its test; see its README.md.

#ifndef POECAL_H
#define POECAL_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

// Most readings of an arm.
#define POECAL_MOST_JOINTS 16

// Most branches of an arm of six joints.
#define POECAL_MOST_BRANCHES 16

// The tip is at the intended pose.
#define POECAL_REACHED 0

// The tip's point is at the intended position, but its orientation is not, near a singularity.
#define POECAL_TURNED 1

// The tip is as near as an arm of fewer than six joints can reach.
#define POECAL_NEAREST 2

// The arm does not reach the pose: the readings are the intended ones.
#define POECAL_OUT_OF_REACH 3

// A joint would have to move too far: the readings are the intended ones.
#define POECAL_TOO_FAR 4

// An arm.
typedef struct PoecalArm PoecalArm;

// Corrections of readings.
typedef struct PoecalCorrections PoecalCorrections;

// Remainder of an inverse: 0 for a reached pose.
typedef struct {
  // Distance, metres.
  double position_m;
  // Angle, radians.
  double rotation_rad;
} PoecalLeft;

// Outcome of a correction of readings.
typedef struct {
  // Remaining distance, metres.
  double position_m;
  // Remaining angle, radians.
  double rotation_rad;
  // `POECAL_REACHED` and the following; -1 for null.
  int32_t outcome;
} PoecalCorrected;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The arm of these numbers; null if they describe none. Allocates; takes some milliseconds for an arm of six joints.
//
// # Safety
// `numbers` is null or points to `count` numbers.
PoecalArm *poecal_arm_new(const double *numbers,
                          size_t count);

// Frees an arm.
//
// # Safety
// `arm` is null or was made by `poecal_arm_new`, and is not used afterwards.
void poecal_arm_free(PoecalArm *arm);

// Number of readings; 0 for null.
//
// # Safety
// `arm` is null or was made by `poecal_arm_new`.
size_t poecal_joints(const PoecalArm *arm);

// The pose of the tip at readings; returns 0, or -1 for null.
//
// # Safety
// `arm` is null or was made by `poecal_arm_new`; `q` is null or points to `poecal_joints(arm)` numbers, `pose` to 16.
int32_t poecal_forward(const PoecalArm *arm,
                       const double *q,
                       double *pose);

// Jacobian of the tip, six numbers for each reading: motion of its point (x, y, z), and its turn, in the base; returns 0, or -1 for null.
//
// # Safety
// As `poecal_forward`; `jacobian` is null or points to 6 times `poecal_joints(arm)` numbers.
int32_t poecal_jacobian(const PoecalArm *arm,
                        const double *q,
                        double *jacobian);

// Moves readings to the nearest configuration that has the tip at a pose, or as close to it as possible; returns the remainder, NaN for null.
//
// # Safety
// As `poecal_forward`; `pose` is null or points to 16 numbers.
PoecalLeft poecal_nearest(const PoecalArm *arm,
                          const double *pose,
                          double *q);

// All configurations of an arm of six turning joints that have its tip at a pose, six readings (-π to π) each; returns their number, or -1 for null
// or for another arm.
//
// # Safety
// `arm` is null or was made by `poecal_arm_new`; `pose` is null or points to 16 numbers, `q` to 6 times `POECAL_MOST_BRANCHES`.
int32_t poecal_branches(const PoecalArm *arm,
                        const double *pose,
                        double *q);

// Corrections of readings for a nominal and an actual arm; null for null, for arms with different joints, or for limits that are not above 0. The
// limits are the largest motions of a joint beyond its zero: of one that turns, and of one that slides; 2 degrees and 2 mm are usual. Allocates;
// takes some hundred microseconds. The arms may be freed afterwards.
//
// # Safety
// The arms are null or were made by `poecal_arm_new`.
PoecalCorrections *poecal_corrections_new(const PoecalArm *nominal,
                                          const PoecalArm *actual,
                                          double most_turn_rad,
                                          double most_slide_m);

// Frees corrections.
//
// # Safety
// `corrections` is null or was made by `poecal_corrections_new`, and is not used afterwards.
void poecal_corrections_free(PoecalCorrections *corrections);

// Readings with which the actual arm's tip has the pose of the nominal one's at the readings `meant`, on the same branch; if there are none, `q` is
// `meant`. Returns the outcome, NaN for null.
//
// # Safety
// `corrections` is null or was made by `poecal_corrections_new`; `meant` and `q` are null or point to `poecal_joints` of its arms numbers.
PoecalCorrected poecal_compensate(const PoecalCorrections *corrections,
                                  const double *meant,
                                  double *q);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* POECAL_H */
