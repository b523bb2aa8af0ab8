/* Promise: no arguments end the program. 100 000 calls get null pointers, wrong lengths, numbers that are not finite,
 * invalid text and other objects. */
#include <kinopt/kinopt.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"

#define CALLS 100000
#define LENGTH 256

static unsigned long long state = 1;

static size_t below(size_t count) {
  state = state * 6364136223846793005ULL + 1442695040888963407ULL;
  return (size_t)(state >> 33) % count;
}

static const double NUMBERS[] = {0.0, 1.0, -1.0, 0.3, 1e-12, 1e308, NAN, INFINITY, -INFINITY};

static double number(void) { return NUMBERS[below(sizeof NUMBERS / sizeof *NUMBERS)]; }

/* An array of 256 numbers: null, a placement at its start, small numbers, or any. */
static const double *array(void) {
  static double numbers[4][LENGTH];
  double *all = numbers[below(4)];
  size_t kind = below(6);
  if (kind == 0) return NULL;
  for (size_t k = 0; k < LENGTH; ++k) {
    all[k] = kind < 4 ? (k % 16 % 5 == 0 ? 1.0 : 0.0) : kind == 4 ? 0.01 * (double)(k % 20) : number();
  }
  if (kind < 4) all[12] = 0.3, all[13] = 0.1, all[14] = 0.5;
  return all;
}

static double *place(void) {
  static double numbers[LENGTH];
  return below(8) == 0 ? NULL : numbers;
}

static size_t length(void) {
  static const size_t lengths[] = {0, 1, 3, 6, 7, 7, 7, 14, 16, 42, LENGTH, (size_t)-1, (size_t)-1 / 8};
  return lengths[below(sizeof lengths / sizeof *lengths)];
}

/* Lengths for arrays of the caller, which must be as long. */
static size_t short_length(void) {
  size_t any = length();
  return any > LENGTH ? LENGTH : any;
}

static const char *text(void) {
  static const char *texts[] = {
      NULL, "", "base", "flange", "tool", "ball", "\xff\xfe", "{", "{}", "[]", "null", "{\"goal\": 3}",
      "{\"goal\": \"position\"}", "{\"attempts\": 1}", "{\"attempts\": -1}", "{\"nothing\": 1}", "{\"seed\": 1e300}",
      "{\"base_joint\": \"free\"}", "{\"seed\": 1, \"seed\": 1}", "{\"held\": {\"x\": 1}}", "{\"locked\": {\"nothing\": 1}}", "{\"only\": [\"panda_joint1\"]}",
      "[{\"kind\": \"point\", \"frame\": \"flange\", \"target\": [0.4, 0, 0.5]}]",
      "[{\"kind\": \"point\", \"frame\": \"flange\"}]", "[{\"kind\": \"posture\", \"reference\": [0]}]",
      "[{\"kind\": \"bounded\", \"task\": {\"kind\": \"bounded\"}}]", "point of `flange`",
      "<robot name='r'><link name='a'/></robot>", "<robot", "/nothing/robot.urdf"};
  return texts[below(sizeof texts / sizeof *texts)];
}

static bool accept(const double *q, size_t q_length, void *data) {
  (void)data;
  return q_length > 0 && q[0] > 0.0;
}

#define ANY(object) (below(10) == 0 ? NULL : (object))

int main(int count, char **arguments) {
  char path[1024];
  snprintf(path, sizeof path, "%s/franka_panda.urdf", count > 1 ? arguments[1] : "models");
  KinoptRobot *robot = NULL;
  KinoptArm *arm = NULL, *safe = NULL;
  KinoptWorld *world = NULL;
  KinoptCollisionModel *model = NULL;
  KinoptSolution *solution = NULL;
  KinoptServo *servo = NULL;
  KinoptJointPath *joint_path = NULL;
  KinoptTrajectory *trajectory = NULL;
  KinoptProblem *problem = NULL;
  KinoptTargets *targets = NULL;
  KinoptSolver *solver = NULL;
  KinoptJacobian *jacobian = NULL;
  double start[7], pose[32], many[7];
  for (int k = 0; k < 7; ++k) many[k] = 2.0;
  OK(kinopt_robot_read(path, NULL, &robot));
  OK(kinopt_arm_new(robot, "base", "flange", "{\"attempts\": 4}", &arm));
  OK(kinopt_arm_default_start(arm, start, 7));
  OK(kinopt_arm_base_from_tool(arm, start, 7, pose));
  memcpy(pose + 16, pose, 16 * sizeof *pose);
  pose[16 + 13] += 0.01;
  OK(kinopt_world_new(&world));
  OK(kinopt_world_add_sphere(world, "ball", 0.1, NULL));
  OK(kinopt_collision_model_new(robot, &model));
  OK(kinopt_arm_new_in_world(robot, "base", "flange", model, world, 0.0, NULL, 0, "{\"attempts\": 4}", &safe));
  OK(kinopt_solution_new(&solution));
  OK(kinopt_servo_new(arm, start, 7, 1e-3, NULL, &servo));
  OK(kinopt_arm_solve_path(arm, pose, 2, NULL, &joint_path));
  OK(kinopt_joint_path_trajectory(joint_path, arm, NULL, many, NULL, 7, NULL, &trajectory));
  OK(kinopt_problem_new(robot, "[{\"kind\": \"point\", \"frame\": \"flange\", \"target\": [0.4, 0, 0.5]}]", NULL, NULL, 0,
                        NULL, &problem));
  OK(kinopt_targets_new(problem, &targets));
  OK(kinopt_solver_new("{\"attempts\": 2}", &solver));
  OK(kinopt_jacobian_new(arm, &jacobian));

  size_t errors = 0, messages = 0;
  for (long call = 0; call < CALLS; ++call) {
    const KinoptArm *any_arm = ANY(below(8) == 0 ? safe : arm);
    KinoptStatus status = KINOPT_STATUS_OK;
    char buffer[64];
    size_t size = 0;
    bool flag = false;
    KinoptOutcome outcomes[LENGTH];
    switch (below(47)) {
    case 0: {
      KinoptRobot *other = NULL;
      status = kinopt_robot_parse(text(), text(), text(), ANY(&other));
      kinopt_robot_free(other);
      break;
    }
    case 1: {
      KinoptRobot *other = NULL;
      status = kinopt_robot_read(text(), text(), ANY(&other));
      kinopt_robot_free(other);
      break;
    }
    case 2: {
      KinoptArm *other = NULL;
      /* The seed table takes milliseconds to build. */
      const char *settings = below(40) == 0 ? text() : "{\"nothing\": 1}";
      status = kinopt_arm_new(ANY(robot), text(), text(), settings, ANY(&other));
      kinopt_arm_free(other);
      break;
    }
    case 3: {
      KinoptArm *other = NULL;
      status = kinopt_arm_with_tool(any_arm, array(), ANY(&other));
      kinopt_arm_free(other);
      break;
    }
    case 4: {
      KinoptArm *other = NULL;
      status = kinopt_arm_with_world(any_arm, ANY(world), number(), ANY(&other));
      kinopt_arm_free(other);
      break;
    }
    case 5: {
      KinoptArm *other = NULL;
      status = kinopt_arm_with_bounds(any_arm, number(), array(), short_length(), ANY(&other));
      kinopt_arm_free(other);
      break;
    }
    case 6: status = kinopt_arm_limits(any_arm, place(), place(), length()); break;
    case 7: status = kinopt_arm_default_start(any_arm, place(), length()); break;
    case 8: status = kinopt_arm_base_from_tool(any_arm, array(), short_length(), place()); break;
    case 9: status = kinopt_arm_collides(any_arm, array(), short_length(), ANY(&flag)); break;
    case 10:
    case 11: status = kinopt_arm_solve(any_arm, array(), array(), short_length(), ANY(solution)); break;
    case 12:
      status = kinopt_arm_solve_accepted(ANY(arm), array(), array(), short_length(), ANY(accept), NULL, ANY(solution),
                                         ANY(&flag));
      break;
    case 13:
      status = kinopt_arm_solve_all(ANY(arm), array(), array(), short_length(), place(), below(20), ANY(&size),
                                    ANY(&flag));
      break;
    case 14:
      status = kinopt_arm_solve_batch(ANY(arm), array(), below(4), array(), short_length(), 1, place(), short_length(),
                                      ANY(outcomes), below(5));
      break;
    case 15: status = kinopt_solution_outcome(ANY(solution), ANY(outcomes)); break;
    case 16: status = kinopt_solution_explain(ANY(solution), ANY(buffer), below(65), ANY(&size)); break;
    case 17:
      status = kinopt_solution_collision(ANY(solution), length(), ANY(buffer), ANY(buffer + 32), below(33), place());
      break;
    case 18:
    case 19: status = kinopt_servo_step(ANY(servo), array(), place(), length(), NULL); break;
    case 20: status = kinopt_servo_stop(ANY(servo), place(), length(), NULL); break;
    case 21: status = kinopt_servo_motion(ANY(servo), place(), place(), length()); break;
    case 22: status = kinopt_servo_limits(ANY(servo), place(), place(), place(), length()); break;
    case 23: {
      KinoptServo *other = NULL;
      status = kinopt_servo_new(any_arm, array(), short_length(), number(), text(), ANY(&other));
      kinopt_servo_free(other);
      break;
    }
    case 24: {
      KinoptJointPath *other = NULL;
      status = kinopt_arm_solve_path(ANY(arm), array(), below(40) == 0 ? 1 : 0, text(), ANY(&other));
      kinopt_joint_path_free(other);
      break;
    }
    case 25: {
      KinoptJointJump jump;
      status = kinopt_joint_path_jump(ANY(joint_path), length(), ANY(&jump));
      break;
    }
    case 26: {
      KinoptMissedPoint missed;
      status = kinopt_joint_path_missed(ANY(joint_path), length(), ANY(&missed));
      break;
    }
    case 27: {
      KinoptTrajectory *other = NULL;
      status = kinopt_joint_path_trajectory(ANY(joint_path), any_arm, array(), array(), NULL, short_length(), text(),
                                            ANY(&other));
      kinopt_trajectory_free(other);
      break;
    }
    case 28: status = kinopt_trajectory_at(ANY(trajectory), number(), place(), place(), place(), length()); break;
    case 29: status = kinopt_trajectory_times(ANY(trajectory), place(), length()); break;
    case 30: status = kinopt_world_add_box(ANY(world), text(), array(), array()); break;
    case 31: status = kinopt_world_add_sphere(ANY(world), text(), number(), array()); break;
    case 32: status = kinopt_world_move(ANY(world), text(), array()); break;
    case 33: status = kinopt_world_remove(ANY(world), text()); break;
    case 34: status = kinopt_world_allow_collision(ANY(world), text(), text()); break;
    case 35: {
      KinoptProblem *other = NULL;
      status = kinopt_problem_new(ANY(robot), text(), ANY(model), ANY(world), number(), text(), ANY(&other));
      kinopt_problem_free(other);
      break;
    }
    case 36: status = kinopt_targets_set_numbers(ANY(targets), ANY(problem), text(), array(), short_length()); break;
    case 37: status = kinopt_targets_set_placement(ANY(targets), ANY(problem), text(), array()); break;
    case 38:
      status = kinopt_solver_solve(ANY(solver), ANY(problem), ANY(targets), array(), short_length(), ANY(solution));
      break;
    case 39: {
      size_t row = 0;
      status = kinopt_joint_path_blocked(ANY(joint_path), length(), ANY(&row));
      CHECK(kinopt_joint_path_missed_reason(ANY(joint_path), length()) == NULL);
      CHECK(kinopt_joint_path_blocked_pair(ANY(joint_path), length()) == NULL);
      break;
    }
    case 40: status = kinopt_servo_held_by(ANY(servo), length(), ANY(buffer), below(65), ANY(&size)); break;
    case 41:
      status = kinopt_servo_collision(ANY(servo), length(), ANY(buffer), ANY(buffer + 32), below(33), place());
      break;
    case 42: {
      static const uint32_t triangles[] = {0, 1, 2, 2, 1, 3, 9, 9, 9, 0, 0, 0};
      status = kinopt_world_add_mesh(ANY(world), text(), array(), below(86), ANY(triangles), below(5), array());
      break;
    }
    case 43: status = kinopt_world_add_points(ANY(world), text(), array(), below(86), number(), array()); break;
    case 44: status = kinopt_world_attach(ANY(world), text(), text(), array()); break;
    case 45: status = kinopt_world_detach(ANY(world), text(), array()); break;
    default: status = kinopt_jacobian_at(ANY(jacobian), array(), short_length(), place(), length()); break;
    }
    CHECK(status != KINOPT_STATUS_INTERNAL);
    errors += status != KINOPT_STATUS_OK;
    messages += status != KINOPT_STATUS_OK && strlen(kinopt_error_message()) > 8;
  }
  CHECK(errors > CALLS / 4 && errors < CALLS - CALLS / 20);
  CHECK(messages == errors);
  printf("%zu of %d calls were errors\n", errors, CALLS);

  kinopt_jacobian_free(jacobian);
  kinopt_solver_free(solver);
  kinopt_targets_free(targets);
  kinopt_problem_free(problem);
  kinopt_trajectory_free(trajectory);
  kinopt_joint_path_free(joint_path);
  /* The arm before its servo: any order is allowed. */
  kinopt_arm_free(arm);
  kinopt_servo_free(servo);
  kinopt_solution_free(solution);
  kinopt_collision_model_free(model);
  kinopt_world_free(world);
  kinopt_arm_free(safe);
  kinopt_robot_free(robot);
  return failures;
}
