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

// The tip is where it was meant.
#define POECAL_REACHED 0

// Its point is, its orientation is not, near a singularity.
#define POECAL_TURNED 1

// It is as near as an arm of fewer than six joints can have it.
#define POECAL_NEAREST 2

// The arm does not reach it: the readings are those that were meant.
#define POECAL_OUT_OF_REACH 3

// A joint would have to move too far: the readings are those that were meant.
#define POECAL_TOO_FAR 4

// An arm.
typedef struct PoecalArm PoecalArm;

// Corrections of readings.
typedef struct PoecalCorrections PoecalCorrections;

// What an inverse leaves: 0 of a pose that is reached.
typedef struct {
  // Distance, metres.
  double position_m;
  // Angle, radians.
  double rotation_rad;
} PoecalLeft;

// What became of readings that were to be corrected.
typedef struct {
  // Distance that is left, metres.
  double position_m;
  // Angle that is left, radians.
  double rotation_rad;
  // `POECAL_REACHED` and the following; -1 of null.
  int32_t outcome;
} PoecalCorrected;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The arm of these numbers; null if they are none. Allocates; takes some milliseconds of an arm of six joints.
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

// Number of readings; 0 of null.
//
// # Safety
// `arm` is null or was made by `poecal_arm_new`.
size_t poecal_joints(const PoecalArm *arm);

// The pose of the tip at readings; returns 0, or -1 of null.
//
// # Safety
// `arm` is null or was made by `poecal_arm_new`; `q` is null or points to `poecal_joints(arm)` numbers, `pose` to 16.
int32_t poecal_forward(const PoecalArm *arm,
                       const double *q,
                       double *pose);

// How the tip moves with each reading, six numbers a reading: of its point (x, y, z), and its turn, in the base; returns 0, or -1 of null.
//
// # Safety
// As `poecal_forward`; `jacobian` is null or points to 6 times `poecal_joints(arm)` numbers.
int32_t poecal_jacobian(const PoecalArm *arm,
                        const double *q,
                        double *jacobian);

// Takes readings to the nearest configuration that has the tip at a pose, or as close to it as can be; what is left, NaN of null.
//
// # Safety
// As `poecal_forward`; `pose` is null or points to 16 numbers.
PoecalLeft poecal_nearest(const PoecalArm *arm,
                          const double *pose,
                          double *q);

// All configurations of an arm of six turning joints that have its tip at a pose, six readings (-π to π) each; returns their number, or -1
// of null or of another arm.
//
// # Safety
// `arm` is null or was made by `poecal_arm_new`; `pose` is null or points to 16 numbers, `q` to 6 times `POECAL_MOST_BRANCHES`.
int32_t poecal_branches(const PoecalArm *arm,
                        const double *pose,
                        double *q);

// Corrections of readings for a nominal and an actual arm; null of null, of arms with different joints, or of sizes that are not above 0.
// How far a joint may move beyond its zero: one that turns, and one that slides; 2 degrees and 2 mm are usual. Allocates; takes some hundred
// microseconds. The arms may be freed afterwards.
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

// Readings with which the actual arm has its tip where the nominal one has it at the readings `meant`, on the same branch; where there are
// none, `q` is `meant`. What became of it, NaN of null.
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
