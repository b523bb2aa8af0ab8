/* Promise: queries from C reach their targets, within limits, as forward kinematics says. */
#include <kinopt/kinopt.h>

#include <math.h>
#include <string.h>

#include "check.h"

#define JOINTS 7

/* Largest difference of two placements. */
static double difference(const double *a, const double *b) {
  double largest = 0.0;
  for (int k = 0; k < 16; ++k) largest = fmax(largest, fabs(a[k] - b[k]));
  return largest;
}

struct Offered {
  int count;
  double first[JOINTS];
};

/* Accepts the second configuration, which differs from the first. */
static bool accept_second(const double *q, size_t length, void *data) {
  struct Offered *offered = data;
  if (length != JOINTS) return false;
  if (offered->count++ == 0) memcpy(offered->first, q, sizeof offered->first);
  return offered->count == 2;
}

int main(int count, char **arguments) {
  char path[1024];
  snprintf(path, sizeof path, "%s/franka_panda.urdf", count > 1 ? arguments[1] : "models");
  KinoptRobot *robot = NULL;
  KinoptArm *arm = NULL;
  KinoptSolution *solution = NULL;
  OK(kinopt_robot_read(path, NULL, &robot));
  OK(kinopt_arm_new(robot, "base", "flange", NULL, &arm));
  OK(kinopt_solution_new(&solution));
  CHECK(kinopt_arm_joint_count(arm) == JOINTS);
  CHECK(strcmp(kinopt_arm_joint_name(arm, 0), "panda_joint1") == 0 || kinopt_arm_joint_name(arm, 0) != NULL);
  CHECK(kinopt_arm_joint_name(arm, JOINTS) == NULL);

  double lower[JOINTS], upper[JOINTS], start[JOINTS], q[JOINTS], target[16], at[16];
  OK(kinopt_arm_limits(arm, lower, upper, JOINTS));
  OK(kinopt_arm_default_start(arm, start, JOINTS));

  /* Poses of configurations within the limits. */
  double targets[20 * 16], batch[20 * JOINTS];
  KinoptOutcome outcomes[20];
  for (int query = 0; query < 20; ++query) {
    for (int j = 0; j < JOINTS; ++j) {
      q[j] = lower[j] + (upper[j] - lower[j]) * (0.5 + 0.4 * sin(1.0 + 3.7 * query + 1.3 * j));
    }
    OK(kinopt_arm_base_from_tool(arm, q, JOINTS, targets + 16 * query));
    OK(kinopt_arm_solve(arm, targets + 16 * query, start, JOINTS, solution));
    CHECK(kinopt_solution_reached(solution));
    size_t length = 0;
    const double *found = kinopt_solution_q(solution, &length);
    CHECK(length == JOINTS);
    for (int j = 0; j < JOINTS; ++j) CHECK(lower[j] <= found[j] && found[j] <= upper[j]);
    OK(kinopt_arm_base_from_tool(arm, found, JOINTS, at));
    CHECK(difference(at, targets + 16 * query) < 3e-6);
    OK(kinopt_solution_outcome(solution, &outcomes[0]));
    CHECK(outcomes[0].position_error < 1e-6 && outcomes[0].attempts >= 1);
  }
  for (size_t threads = 0; threads < 3; ++threads) {
    OK(kinopt_arm_solve_batch(arm, targets, 20, start, JOINTS, threads, batch, 20 * JOINTS, outcomes, 20));
    for (int query = 0; query < 20; ++query) {
      CHECK(outcomes[query].reached);
      OK(kinopt_arm_solve(arm, targets + 16 * query, start, JOINTS, solution));
      CHECK(memcmp(kinopt_solution_q(solution, NULL), batch + JOINTS * query, sizeof q) == 0);
    }
  }

  /* A callback that rejects the first solution gets another one. */
  struct Offered offered = {0, {0}};
  bool accepted = false;
  OK(kinopt_arm_solve_accepted(arm, targets, start, JOINTS, accept_second, &offered, solution, &accepted));
  CHECK(accepted && offered.count == 2);
  CHECK(memcmp(kinopt_solution_q(solution, NULL), offered.first, sizeof q) != 0);
  OK(kinopt_arm_base_from_tool(arm, kinopt_solution_q(solution, NULL), JOINTS, at));
  CHECK(difference(at, targets) < 3e-6);

  /* Bounds of a query. */
  KinoptArm *bounded = NULL;
  double most[JOINTS];
  for (int j = 0; j < JOINTS; ++j) most[j] = 0.05;
  OK(kinopt_arm_with_bounds(arm, INFINITY, most, JOINTS, &bounded));
  OK(kinopt_arm_solve(bounded, targets, start, JOINTS, solution));
  for (int j = 0; j < JOINTS; ++j) CHECK(fabs(kinopt_solution_q(solution, NULL)[j] - start[j]) <= 0.05 + 1e-15);

  /* A target out of reach is a result, with an explanation. */
  memcpy(target, targets, sizeof target);
  target[12] = 9.0;
  OK(kinopt_arm_solve(arm, target, start, JOINTS, solution));
  CHECK(!kinopt_solution_reached(solution));
  char text[1024];
  size_t length = 0;
  OK(kinopt_solution_explain(solution, text, sizeof text, &length));
  CHECK(strlen(text) == length && strncmp(text, "Not reached", 11) == 0);
  OK(kinopt_solution_explain(solution, text, 8, &length));
  CHECK(strcmp(text, "Not rea") == 0 && length > 7);

  /* Jacobian: differences of forward kinematics. */
  KinoptJacobian *jacobian = NULL;
  double columns[6 * JOINTS];
  OK(kinopt_jacobian_new(arm, &jacobian));
  OK(kinopt_jacobian_at(jacobian, start, JOINTS, columns, 6 * JOINTS));
  for (int j = 0; j < JOINTS; ++j) {
    double before[16], after[16], step = 1e-6;
    memcpy(q, start, sizeof q);
    q[j] = start[j] - step;
    OK(kinopt_arm_base_from_tool(arm, q, JOINTS, before));
    q[j] = start[j] + step;
    OK(kinopt_arm_base_from_tool(arm, q, JOINTS, after));
    for (int row = 0; row < 3; ++row) {
      CHECK(fabs((after[12 + row] - before[12 + row]) / (2 * step) - columns[6 * j + row]) < 1e-8);
    }
  }

  /* Errors have a status and a message. */
  KinoptArm *none = NULL;
  CHECK(kinopt_arm_new(robot, "base", "nowhere", NULL, &none) == KINOPT_STATUS_UNKNOWN_NAME && none == NULL);
  CHECK(strstr(kinopt_error_message(), "nowhere") != NULL);
  CHECK(kinopt_robot_read("/nothing.urdf", NULL, &robot) == KINOPT_STATUS_FILE);
  CHECK(kinopt_arm_solve(arm, targets, start, 6, solution) == KINOPT_STATUS_INVALID_VALUE);

  /* JSON that is none is named. */
  CHECK(kinopt_arm_new(robot, "base", "flange", "{\"seed\": nan}", &none) == KINOPT_STATUS_INVALID_VALUE);
  CHECK(strstr(kinopt_error_message(), "`settings`") != NULL);
  CHECK(kinopt_arm_new(robot, "base", "flange", "[1]", &none) == KINOPT_STATUS_INVALID_VALUE);
  CHECK(strstr(kinopt_error_message(), "`settings`") != NULL);
  KinoptProblem *problem = NULL;
  CHECK(kinopt_problem_new(robot, "[{", NULL, NULL, 0.0, NULL, &problem) == KINOPT_STATUS_INVALID_VALUE);
  CHECK(strstr(kinopt_error_message(), "`tasks`") != NULL);

  kinopt_jacobian_free(jacobian);
  kinopt_arm_free(bounded);
  kinopt_solution_free(solution);
  kinopt_arm_free(arm);
  kinopt_robot_free(robot);
  return failures;
}
