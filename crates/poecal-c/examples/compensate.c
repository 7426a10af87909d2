// Corrects a configuration: what to command so that the robot as it is does what one like its drawing would.
//
//   poecal export results/calibration.json --format c --model corrected --out arms.h
//   cc -O2 -I. -Icrates/poecal-c/include crates/poecal-c/examples/compensate.c libpoecal_c.a -lm -o compensate
//   ./compensate 0.1 0.2 0.3 0.4 0.5 0.6
#include <stdio.h>
#include <stdlib.h>

#include "arms.h"
#include "poecal.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

int main(int count, char **arguments) {
  PoecalArm *nominal = poecal_arm_new(poecal_nominal, COUNT(poecal_nominal));
  PoecalArm *actual = poecal_arm_new(poecal_actual, COUNT(poecal_actual));
  size_t joints = poecal_joints(actual);
  if (nominal == NULL || actual == NULL || (size_t)count != joints + 1) {
    fprintf(stderr, "expected %zu joint readings\n", joints);
    return 2;
  }
  double meant[POECAL_MOST_JOINTS], q[POECAL_MOST_JOINTS], pose[16];
  for (size_t i = 0; i < joints; i++) meant[i] = strtod(arguments[i + 1], NULL);

  // No joint moves by more than 2 degrees, or 2 mm, beyond its zero.
  PoecalCorrections *corrections = poecal_corrections_new(nominal, actual, 0.0349, 0.002);
  PoecalCorrected left = poecal_compensate(corrections, meant, q);
  for (size_t i = 0; i < joints; i++) printf("%.15g\n", q[i]);
  fprintf(stderr, "outcome %d, left: %.1e m, %.1e rad\n", left.outcome, left.position_m, left.rotation_rad);

  // All ways to have the tip there, of an arm of six turning joints.
  double branches[6 * POECAL_MOST_BRANCHES];
  poecal_forward(nominal, meant, pose);
  fprintf(stderr, "branches: %d\n", poecal_branches(actual, pose, branches));

  poecal_corrections_free(corrections);
  poecal_arm_free(actual);
  poecal_arm_free(nominal);
  return left.outcome == POECAL_REACHED || left.outcome == POECAL_TURNED ? 0 : 1;
}
