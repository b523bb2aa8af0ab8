/* C interface of kinopt, inverse kinematics by optimisation. Licence: MIT or Apache-2.0.
 * Generated from the Rust sources: do not edit.
 *
 * Units are metres, radians and seconds. Placements are sixteen numbers: a 4 x 4 matrix by columns, as in Eigen.
 * Settings are JSON objects with the library's options by name, or null for the defaults. Infinite numbers are the texts
 * "inf" and "-inf". An option that is unknown or given twice is an error.
 *
 * Functions return a status; kinopt_error_message() has the text of the last error of the calling thread.
 * A target that is not reached is no error.
 *
 * The caller frees every object once by its _free function, in any order; null is ignored. Robots, arms, collision models, problems and joint
 * paths are immutable and shared between threads. Other objects are used by one thread at a time.
 *
 * No panic and no exception crosses this interface. A callback must not throw.
 */

#ifndef KINOPT_H
#define KINOPT_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

/**
 * Result of a function.
 */
typedef enum {
  /**
   * Success; also for a target that is not reached.
   */
  KINOPT_STATUS_OK = 0,
  /**
   * An invalid argument: null, a wrong length, a number out of range, text that is not UTF-8.
   */
  KINOPT_STATUS_INVALID_VALUE = 1,
  /**
   * An unknown name of a frame, joint, task or option.
   */
  KINOPT_STATUS_UNKNOWN_NAME = 2,
  /**
   * A file with invalid content.
   */
  KINOPT_STATUS_INVALID_FILE = 3,
  /**
   * A file that cannot be read.
   */
  KINOPT_STATUS_FILE = 4,
  /**
   * A defect of the library.
   */
  KINOPT_STATUS_INTERNAL = 5,
} KinoptStatus;

/**
 * State of a servo after a cycle.
 */
typedef enum {
  /**
   * The tool is within the tolerances of its target.
   */
  KINOPT_SERVO_STATUS_ON_TARGET = 0,
  /**
   * Moving to the target as fast as a velocity, acceleration or jerk limit allows.
   */
  KINOPT_SERVO_STATUS_SPEED_LIMITED = 1,
  /**
   * Moving to the target with no joint at a limit.
   */
  KINOPT_SERVO_STATUS_SETTLING = 2,
  /**
   * At rest at the closest pose of the current branch.
   */
  KINOPT_SERVO_STATUS_NEAREST = 3,
  /**
   * Braking or at rest before a collision.
   */
  KINOPT_SERVO_STATUS_BLOCKED = 4,
  /**
   * A pair that was in contact at the start still is.
   */
  KINOPT_SERVO_STATUS_TOUCHING = 5,
  /**
   * Braking after `kinopt_servo_stop`.
   */
  KINOPT_SERVO_STATUS_STOPPING = 6,
  /**
   * At rest after `kinopt_servo_stop`.
   */
  KINOPT_SERVO_STATUS_STOPPED = 7,
} KinoptServoStatus;

/**
 * An arm: the joints from a base to a tip of a robot, prepared for queries. It is immutable.
 */
typedef struct KinoptArm KinoptArm;

/**
 * Collision shapes of a robot and its enabled collision pairs. It is immutable, and its creation is expensive.
 */
typedef struct KinoptCollisionModel KinoptCollisionModel;

/**
 * Jacobian of an arm's tool, compiled once. One thread uses it at a time.
 */
typedef struct KinoptJacobian KinoptJacobian;

/**
 * Joint path: one configuration for each point. It is immutable.
 */
typedef struct KinoptJointPath KinoptJointPath;

/**
 * Tasks on a robot, checked and compiled. It is immutable.
 */
typedef struct KinoptProblem KinoptProblem;

/**
 * A robot: joints, links, limits. It is immutable.
 */
typedef struct KinoptRobot KinoptRobot;

/**
 * Servo of an arm. One thread uses it at a time. A cycle allocates nothing.
 */
typedef struct KinoptServo KinoptServo;

/**
 * Result of a query, reached or not. It can be used for any number of queries, one after another.
 */
typedef struct KinoptSolution KinoptSolution;

/**
 * Levenberg-Marquardt solver with its workspace. One thread uses it at a time.
 */
typedef struct KinoptSolver KinoptSolver;

/**
 * Targets of a problem. One thread uses it at a time.
 */
typedef struct KinoptTargets KinoptTargets;

/**
 * Trajectory along a joint path. One thread uses it at a time.
 */
typedef struct KinoptTrajectory KinoptTrajectory;

/**
 * Obstacles by name. One thread uses it at a time; arms and problems copy it.
 */
typedef struct KinoptWorld KinoptWorld;

/**
 * Returns true to accept a configuration of an arm. It must not throw.
 */
typedef bool (*KinoptAccept)(const double *q, size_t q_length, void *user_data);

/**
 * Errors and effort of a query.
 */
typedef struct {
  /**
   * True if every required task is within its tolerance, and the configuration is collision-free.
   */
  bool reached;
  /**
   * Largest position error, metres; NaN without a task that has a position.
   */
  double position_error;
  /**
   * Largest orientation error, radians; NaN without a task that has an orientation.
   */
  double orientation_error;
  /**
   * Iterations of all attempts.
   */
  uint32_t iterations;
  /**
   * Number of attempts.
   */
  uint32_t attempts;
} KinoptOutcome;

/**
 * A step of a path in which a joint moves farther than its bound.
 */
typedef struct {
  /**
   * Index of the row after the step.
   */
  size_t index;
  /**
   * Index of the joint.
   */
  size_t joint;
  /**
   * Radians; of a prismatic joint the equivalent angle.
   */
  double distance;
  /**
   * True if the arm leaves its branch.
   */
  bool reconfiguration;
} KinoptJointJump;

/**
 * A point that the tool does not reach, or reaches only in collision: see `kinopt_joint_path_missed_reason`.
 */
typedef struct {
  /**
   * Index of the row.
   */
  size_t index;
  /**
   * Error beyond the goal bounds, metres. It is within the tolerance if the tool reaches the pose in collision.
   */
  double position_error;
  /**
   * Error beyond the goal bounds, radians. It is within the tolerance if the tool reaches the pose in collision.
   */
  double orientation_error;
} KinoptMissedPoint;

/**
 * Errors of a control cycle.
 */
typedef struct {
  /**
   * State of the servo.
   */
  KinoptServoStatus status;
  /**
   * Distance of the tool from its target, metres.
   */
  double position_error;
  /**
   * Angle between the tool and its target, radians.
   */
  double orientation_error;
} KinoptServoStep;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Creates the arm from the frame `base` to the frame `tip`; base null is the world.
 *
 * `settings` are the options of arms of `docs/reference/options.md`: `position_tolerance`, `orientation_tolerance`, `goal`
 * ("pose", "position" or six half widths), `search` ("start", "first", "nearest"), `time_limit`, `seed`, `posture`,
 * `max_move`, `locked`, `only`, `tool` (four rows of four numbers), and others.
 */
KinoptStatus kinopt_arm_new(const KinoptRobot *robot,
                            const char *base,
                            const char *tip,
                            const char *settings,
                            KinoptArm **arm);

/**
 * Creates an arm that avoids collisions of the robot with itself and with a world, by at least `margin` metres.
 *
 * The world is copied. `held` has the positions of the joints outside the arm, a configuration of the robot; null for the
 * neutral one.
 */
KinoptStatus kinopt_arm_new_in_world(const KinoptRobot *robot,
                                     const char *base,
                                     const char *tip,
                                     const KinoptCollisionModel *collision_model,
                                     const KinoptWorld *world,
                                     double margin,
                                     const double *held,
                                     size_t held_length,
                                     const char *settings,
                                     KinoptArm **arm);

/**
 * Creates the arm with another world, which is copied. The arm already avoids collisions.
 */
KinoptStatus kinopt_arm_with_world(const KinoptArm *arm,
                                   const KinoptWorld *world,
                                   double margin,
                                   KinoptArm **changed);

/**
 * Creates the arm with another tool, a placement in the tip's frame. The seed table is shared, so this is fast.
 */
KinoptStatus kinopt_arm_with_tool(const KinoptArm *arm,
                                  const double *tip_from_tool,
                                  KinoptArm **changed);

/**
 * Creates the arm with other bounds of a query: a time limit in seconds (infinite for none), and the largest motion of
 * each joint from the start (null for none). The seed table is shared, so this is fast.
 */
KinoptStatus kinopt_arm_with_bounds(const KinoptArm *arm,
                                    double time_limit,
                                    const double *max_move,
                                    size_t max_move_length,
                                    KinoptArm **changed);

/**
 * Frees an arm.
 */
void kinopt_arm_free(KinoptArm *arm);

/**
 * Number of joints, the length of a configuration; 0 for null.
 */
size_t kinopt_arm_joint_count(const KinoptArm *arm);

/**
 * Name of a joint, from base to tip, valid as long as the arm; null for an index out of range.
 */
const char *kinopt_arm_joint_name(const KinoptArm *arm, size_t index);

/**
 * Writes the position limits of the joints, radians or metres.
 */
KinoptStatus kinopt_arm_limits(const KinoptArm *arm, double *lower, double *upper, size_t length);

/**
 * Writes the default start: the middle of the limits, or the value closest to 0 for a joint without limits.
 */
KinoptStatus kinopt_arm_default_start(const KinoptArm *arm,
                                      double *q,
                                      size_t q_length);

/**
 * Writes the placement of the tool in the base at a configuration.
 */
KinoptStatus kinopt_arm_base_from_tool(const KinoptArm *arm,
                                       const double *q,
                                       size_t q_length,
                                       double *base_from_tool);

/**
 * Writes whether a configuration of an arm that avoids collisions has pairs in collision, or nearer than its margin.
 */
KinoptStatus kinopt_arm_collides(const KinoptArm *arm,
                                 const double *q,
                                 size_t q_length,
                                 bool *collides);

/**
 * Solves for one target of the tool in the base, from a start configuration.
 *
 * `base_from_tool` is a placement. A target that is not reached is no error: see `kinopt_solution_reached` and
 * `kinopt_solution_explain`. A solution can be used again, which avoids allocations.
 */
KinoptStatus kinopt_arm_solve(const KinoptArm *arm,
                              const double *base_from_tool,
                              const double *start,
                              size_t start_length,
                              KinoptSolution *solution);

/**
 * Solves for one target, and offers reached configurations to a callback until it accepts one.
 *
 * The first is that of `kinopt_arm_solve`, then come further ones that differ by 0.1 rad, nearest to the start first. An arm
 * with a time limit searches until it ends, at last for solutions that differ by 0.001 rad, or until further attempts lead to
 * no new solution. `accepted` is false, and the solution is the first one, if the callback rejects all of them or the target
 * is not reached.
 */
KinoptStatus kinopt_arm_solve_accepted(const KinoptArm *arm,
                                       const double *base_from_tool,
                                       const double *start,
                                       size_t start_length,
                                       KinoptAccept accept,
                                       void *user_data,
                                       KinoptSolution *solution,
                                       bool *accepted);

/**
 * Finds all solutions of one target, nearest to the start first.
 *
 * For six revolute joints and a full pose the set is complete: all isolated solutions within the limits, with whole
 * turns. `complete` then becomes true. Other arms return the solutions that their attempts find.
 *
 * Writes up to `capacity` configurations to `q`, one after another. `count` becomes the number of solutions, which may
 * exceed the capacity.
 */
KinoptStatus kinopt_arm_solve_all(const KinoptArm *arm,
                                  const double *base_from_tool,
                                  const double *start,
                                  size_t start_length,
                                  double *q,
                                  size_t capacity,
                                  size_t *count,
                                  bool *complete);

/**
 * Solves for many targets, faster than one after another.
 *
 * `starts` has one configuration for all targets, or one for each, one after another. Configurations are written to `q` and
 * errors to `outcomes`, one for each target. `threads` 0 is all cores; results do not depend on it.
 */
KinoptStatus kinopt_arm_solve_batch(const KinoptArm *arm,
                                    const double *base_from_tools,
                                    size_t target_count,
                                    const double *starts,
                                    size_t starts_length,
                                    size_t threads,
                                    double *q,
                                    size_t q_length,
                                    KinoptOutcome *outcomes,
                                    size_t outcome_count);

/**
 * Text of the last error of the calling thread; empty without one. It is valid until the next call of this thread that
 * fails.
 */
const char *kinopt_error_message(void);

/**
 * Version of the library, such as "0.1.0".
 */
const char *kinopt_version(void);

/**
 * Compiles the Jacobian of an arm's tool.
 */
KinoptStatus kinopt_jacobian_new(const KinoptArm *arm, KinoptJacobian **jacobian);

/**
 * Frees a Jacobian.
 */
void kinopt_jacobian_free(KinoptJacobian *jacobian);

/**
 * Writes the Jacobian at a configuration: six rows by columns, one column for each joint.
 *
 * The rows are the velocity of the tool's origin, m/s, and its angular velocity, rad/s, in the base's axes.
 */
KinoptStatus kinopt_jacobian_at(KinoptJacobian *jacobian,
                                const double *q,
                                size_t q_length,
                                double *matrix,
                                size_t matrix_length);

/**
 * Solves a path of placements of the tool in the base: fewest reconfigurations, then the shortest.
 *
 * `settings`: `traversal` ("open", "cyclic", "any-start"), `start`, `end`, `joint_weights`, `max_step`, `samples`, `times`,
 * `keep_times`. Points that are not reached are no error: see `kinopt_joint_path_reached`.
 */
KinoptStatus kinopt_arm_solve_path(const KinoptArm *arm,
                                   const double *base_from_tools,
                                   size_t point_count,
                                   const char *settings,
                                   KinoptJointPath **path);

/**
 * Frees a joint path.
 */
void kinopt_joint_path_free(KinoptJointPath *path);

/**
 * True if all points are reached without reconfigurations, and all steps are collision-free; false for null.
 */
bool kinopt_joint_path_reached(const KinoptJointPath *path);

/**
 * Number of rows; 0 for null.
 */
size_t kinopt_joint_path_row_count(const KinoptJointPath *path);

/**
 * Configurations, one after another, valid as long as the path; their number of numbers is written to `length`, unless that
 * is null. Null for a path without rows.
 */
const double *kinopt_joint_path_q(const KinoptJointPath *path,
                                  size_t *length);

/**
 * Number of jumps; 0 for null.
 */
size_t kinopt_joint_path_jump_count(const KinoptJointPath *path);

/**
 * Writes a jump.
 */
KinoptStatus kinopt_joint_path_jump(const KinoptJointPath *path,
                                    size_t index,
                                    KinoptJointJump *jump);

/**
 * Number of points that are not reached, or only in collision; 0 for null.
 */
size_t kinopt_joint_path_missed_count(const KinoptJointPath *path);

/**
 * Writes a point that is not reached, or only in collision.
 */
KinoptStatus kinopt_joint_path_missed(const KinoptJointPath *path,
                                      size_t index,
                                      KinoptMissedPoint *missed);

/**
 * Reason why a point is not reached, such as "collision of link `hand` and obstacle `box`", valid as long as the path; null
 * for an index out of range. `index` counts the missed points.
 */
const char *kinopt_joint_path_missed_reason(const KinoptJointPath *path,
                                            size_t index);

/**
 * Number of steps between rows that are not proven collision-free; 0 for null.
 *
 * `kinopt_joint_path_trajectory` counts the rows of missed points and the rows after these steps, each row once.
 */
size_t kinopt_joint_path_blocked_count(const KinoptJointPath *path);

/**
 * Writes the index of the row after a step that is not proven collision-free; 0 for the step that closes a cyclic path.
 */
KinoptStatus kinopt_joint_path_blocked(const KinoptJointPath *path,
                                       size_t index,
                                       size_t *row);

/**
 * Colliding pair of a step that is not proven collision-free, valid as long as the path; null for an index out of range.
 */
const char *kinopt_joint_path_blocked_pair(const KinoptJointPath *path,
                                           size_t index);

/**
 * Creates a problem from a JSON list of tasks.
 *
 * A task is an object with its `kind` and the options of `docs/reference/options.md`:
 * `[{"kind": "pose", "frame": "left_hand", "target": [[…], …]}, {"kind": "posture", "reference": [0, …], "weight": 0.01}]`.
 * A placement has four rows of four numbers. `settings`: `tolerance`, `preferences`, `bounds`, `locked`, `only`, `held`.
 *
 * With a collision model and a world the configurations avoid collisions by `margin` metres; both null for none.
 */
KinoptStatus kinopt_problem_new(const KinoptRobot *robot,
                                const char *tasks,
                                const KinoptCollisionModel *collision_model,
                                const KinoptWorld *world,
                                double margin,
                                const char *settings,
                                KinoptProblem **problem);

/**
 * Frees a problem.
 */
void kinopt_problem_free(KinoptProblem *problem);

/**
 * Number of tasks; 0 for null.
 */
size_t kinopt_problem_task_count(const KinoptProblem *problem);

/**
 * Name of a task, for targets, valid as long as the problem; null for an index out of range.
 */
const char *kinopt_problem_task_name(const KinoptProblem *problem, size_t index);

/**
 * Reads a robot from a URDF or MJCF file.
 *
 * `settings`: `base_joint` ("free", "planar", …), `base_bounds`, `lenient`, `mimic_limits`, `soft_limits`, `confine`.
 */
KinoptStatus kinopt_robot_read(const char *path,
                               const char *settings,
                               KinoptRobot **robot);

/**
 * Reads a robot from the text of a URDF or MJCF file; `name` is the file's name in messages. Settings are those of
 * `kinopt_robot_read`.
 */
KinoptStatus kinopt_robot_parse(const char *text,
                                const char *name,
                                const char *settings,
                                KinoptRobot **robot);

/**
 * Creates the robot with the joint limits of a MoveIt `joint_limits.yaml`.
 */
KinoptStatus kinopt_robot_with_joint_limits(const KinoptRobot *robot,
                                            const char *yaml,
                                            const char *file,
                                            KinoptRobot **limited);

/**
 * Frees a robot.
 */
void kinopt_robot_free(KinoptRobot *robot);

/**
 * Length of a configuration of the robot; 0 for null.
 */
size_t kinopt_robot_configuration_len(const KinoptRobot *robot);

/**
 * Writes the neutral configuration: 0, or the nearest limit; quaternions are w, x, y, z.
 */
KinoptStatus kinopt_robot_neutral(const KinoptRobot *robot, double *q, size_t q_length);

/**
 * Number of frames: links, and the ends of their joints; 0 for null.
 */
size_t kinopt_robot_frame_count(const KinoptRobot *robot);

/**
 * Name of a frame, valid as long as the robot; null for an index out of range.
 */
const char *kinopt_robot_frame_name(const KinoptRobot *robot, size_t index);

/**
 * Creates a servo at rest at the configuration `start`, with `time_step` seconds between two cycles, at most 1.
 *
 * `settings`: `velocity_limits`, `acceleration_limits`, `jerk_limits` (lists with one number for each joint; default: those
 * of the robot's files), `velocity` and `acceleration` at the start, `straight_line`, `damping`.
 */
KinoptStatus kinopt_servo_new(const KinoptArm *arm,
                              const double *start,
                              size_t start_length,
                              double time_step,
                              const char *settings,
                              KinoptServo **servo);

/**
 * Frees a servo.
 */
void kinopt_servo_free(KinoptServo *servo);

/**
 * One control cycle towards a target placement: writes the commanded joint positions to `q`, and its errors to `step`,
 * unless that is null. After an error the servo has not moved.
 */
KinoptStatus kinopt_servo_step(KinoptServo *servo,
                               const double *base_from_tool,
                               double *q,
                               size_t q_length,
                               KinoptServoStep *step);

/**
 * One control cycle of a stop, within the motion limits: as `kinopt_servo_step`. Call it until the status is
 * `KINOPT_SERVO_STATUS_STOPPED`.
 */
KinoptStatus kinopt_servo_stop(KinoptServo *servo,
                               double *q,
                               size_t q_length,
                               KinoptServoStep *step);

/**
 * Writes the limit that determined a joint's motion in the last cycle, such as "upper limit", "speed down" or
 * "acceleration up"; an empty text for none.
 *
 * `joint` counts from base to tip. A text that is longer than the buffer is shortened. Its whole length without the final
 * zero byte is written to `length`, unless that is null.
 */
KinoptStatus kinopt_servo_held_by(const KinoptServo *servo,
                                  size_t joint,
                                  char *buffer,
                                  size_t size,
                                  size_t *length);

/**
 * Number of pairs that blocked the motion of the last cycle, or that are in contact; 0 for null.
 */
size_t kinopt_servo_collision_count(const KinoptServo *servo);

/**
 * Writes a pair that blocked the motion of the last cycle, or that is in contact, the deepest first: as
 * `kinopt_solution_collision`.
 */
KinoptStatus kinopt_servo_collision(const KinoptServo *servo,
                                    size_t index,
                                    char *first,
                                    char *second,
                                    size_t size,
                                    double *distance);

/**
 * Writes the commanded velocities and accelerations of the last cycle; null for those that are not needed.
 */
KinoptStatus kinopt_servo_motion(const KinoptServo *servo,
                                 double *velocity,
                                 double *acceleration,
                                 size_t length);

/**
 * Writes the limits of velocities, accelerations and jerks; infinite for none. Null for those that are not needed.
 */
KinoptStatus kinopt_servo_limits(const KinoptServo *servo,
                                 double *velocities,
                                 double *accelerations,
                                 double *jerks,
                                 size_t length);

/**
 * Creates a solution without content.
 */
KinoptStatus kinopt_solution_new(KinoptSolution **solution);

/**
 * Frees a solution.
 */
void kinopt_solution_free(KinoptSolution *solution);

/**
 * True if every required task is within its tolerance, and the configuration is collision-free; false for null.
 */
bool kinopt_solution_reached(const KinoptSolution *solution);

/**
 * Configuration, valid until the next query with this solution; its length is written to `length`, unless that is null.
 * Null for a solution without content.
 */
const double *kinopt_solution_q(const KinoptSolution *solution,
                                size_t *length);

/**
 * Writes the errors and the effort of the query.
 */
KinoptStatus kinopt_solution_outcome(const KinoptSolution *solution, KinoptOutcome *outcome);

/**
 * Writes an explanation: reached or not, the errors, and the limits or collisions that prevent a better result.
 *
 * A text that is longer than the buffer is shortened. Its whole length without the final zero byte is written to `length`,
 * unless that is null.
 */
KinoptStatus kinopt_solution_explain(const KinoptSolution *solution,
                                     char *buffer,
                                     size_t size,
                                     size_t *length);

/**
 * Number of pairs in collision, or nearer than the margin; 0 for null.
 */
size_t kinopt_solution_collision_count(const KinoptSolution *solution);

/**
 * Writes the distance of a pair in metres, negative for penetration, and the names of its parts: each to a buffer of `size`
 * bytes, shortened if the buffer is too small. Links and obstacles have the names of the robot and the world.
 */
KinoptStatus kinopt_solution_collision(const KinoptSolution *solution,
                                       size_t index,
                                       char *first,
                                       char *second,
                                       size_t size,
                                       double *distance);

/**
 * Creates a solver.
 *
 * `settings`: `max_iterations`, `gradient_tolerance`, `step_tolerance`, `patience`, `time_limit` (seconds), `attempts`,
 * `seed`, `agreeing`, `restart_steps`.
 */
KinoptStatus kinopt_solver_new(const char *settings,
                               KinoptSolver **solver);

/**
 * Frees a solver.
 */
void kinopt_solver_free(KinoptSolver *solver);

/**
 * Solves a problem from a configuration of the robot. `targets` null is those of the tasks. A target that is not reached is
 * no error.
 */
KinoptStatus kinopt_solver_solve(KinoptSolver *solver,
                                 const KinoptProblem *problem,
                                 const KinoptTargets *targets,
                                 const double *start,
                                 size_t start_length,
                                 KinoptSolution *solution);

/**
 * Creates targets, with those of the problem's tasks.
 */
KinoptStatus kinopt_targets_new(const KinoptProblem *problem, KinoptTargets **targets);

/**
 * Frees targets.
 */
void kinopt_targets_free(KinoptTargets *targets);

/**
 * Sets the target of a pose or orientation, or the previous placement of a velocity task.
 */
KinoptStatus kinopt_targets_set_placement(KinoptTargets *targets,
                                          const KinoptProblem *problem,
                                          const char *task,
                                          const double *placement);

/**
 * Sets the target of a task of one number or of a list: x, y, z of a point, a look-at, a gaze or a centre of mass, two
 * pixels, a distance, the values of a posture's joints.
 */
KinoptStatus kinopt_targets_set_numbers(KinoptTargets *targets,
                                        const KinoptProblem *problem,
                                        const char *task,
                                        const double *numbers,
                                        size_t length);

/**
 * Computes the time-optimal trajectory along a joint path of the arm, from rest to rest.
 *
 * Limits have one number for each joint, infinite for none: velocities (rad/s or m/s), accelerations and jerks. Null is the
 * limits of the robot's files; of jerks it is none.
 *
 * A path with missed points or blocked steps is an error, unless the setting `allow_unreached` is true. Other settings are
 * `corner_tolerance`, the largest distance of a joint from the path at a blended corner (radians or metres), and `grid_points`
 * of the speed profile.
 */
KinoptStatus kinopt_joint_path_trajectory(const KinoptJointPath *path,
                                          const KinoptArm *arm,
                                          const double *velocity_limits,
                                          const double *acceleration_limits,
                                          const double *jerk_limits,
                                          size_t limit_count,
                                          const char *settings,
                                          KinoptTrajectory **trajectory);

/**
 * Frees a trajectory.
 */
void kinopt_trajectory_free(KinoptTrajectory *trajectory);

/**
 * Time of the end, seconds; 0 for null.
 */
double kinopt_trajectory_duration(const KinoptTrajectory *trajectory);

/**
 * Writes the time of each row of the path, seconds.
 */
KinoptStatus kinopt_trajectory_times(const KinoptTrajectory *trajectory,
                                     double *times,
                                     size_t length);

/**
 * Writes joint positions, velocities and accelerations at a time in seconds; null for those that are not needed. Before the
 * start and after the end the arm is at rest.
 */
KinoptStatus kinopt_trajectory_at(KinoptTrajectory *trajectory,
                                  double time,
                                  double *q,
                                  double *velocity,
                                  double *acceleration,
                                  size_t length);

/**
 * Creates the collision model of a robot. Pairs of links that are always or never in contact, by sampled configurations,
 * are omitted.
 */
KinoptStatus kinopt_collision_model_new(const KinoptRobot *robot,
                                        KinoptCollisionModel **model);

/**
 * Frees a collision model.
 */
void kinopt_collision_model_free(KinoptCollisionModel *model);

/**
 * Creates a world without obstacles.
 */
KinoptStatus kinopt_world_new(KinoptWorld **world);

/**
 * Reads a world from a file of `docs/guide/worlds.md`.
 */
KinoptStatus kinopt_world_read(const char *path, KinoptWorld **world);

/**
 * Frees a world.
 */
void kinopt_world_free(KinoptWorld *world);

/**
 * Adds a box by its full lengths along x, y and z, three numbers. `pose` is a placement, null for the origin.
 */
KinoptStatus kinopt_world_add_box(KinoptWorld *world,
                                  const char *name,
                                  const double *size,
                                  const double *pose);

/**
 * Adds a sphere.
 */
KinoptStatus kinopt_world_add_sphere(KinoptWorld *world,
                                     const char *name,
                                     double radius,
                                     const double *pose);

/**
 * Adds a cylinder along z.
 */
KinoptStatus kinopt_world_add_cylinder(KinoptWorld *world,
                                       const char *name,
                                       double radius,
                                       double length,
                                       const double *pose);

/**
 * Adds a capsule along z; `length` is that of its segment.
 */
KinoptStatus kinopt_world_add_capsule(KinoptWorld *world,
                                      const char *name,
                                      double radius,
                                      double length,
                                      const double *pose);

/**
 * Adds the half-space below z = 0 of the pose.
 */
KinoptStatus kinopt_world_add_plane(KinoptWorld *world, const char *name, const double *pose);

/**
 * Adds a triangle mesh: `vertices` are x, y, z one after another, metres; `triangles` are three indices of vertices each.
 */
KinoptStatus kinopt_world_add_mesh(KinoptWorld *world,
                                   const char *name,
                                   const double *vertices,
                                   size_t vertex_count,
                                   const uint32_t *triangles,
                                   size_t triangle_count,
                                   const double *pose);

/**
 * Adds spheres of one radius about points: `positions` are x, y, z one after another, metres.
 */
KinoptStatus kinopt_world_add_points(KinoptWorld *world,
                                     const char *name,
                                     const double *positions,
                                     size_t position_count,
                                     double radius,
                                     const double *pose);

/**
 * Attaches an obstacle to a frame of the robot, such as a grasped object to the tool. `pose` is its placement in the frame.
 */
KinoptStatus kinopt_world_attach(KinoptWorld *world,
                                 const char *name,
                                 const char *frame,
                                 const double *pose);

/**
 * Detaches an obstacle from its frame; `pose` is its placement in the world.
 */
KinoptStatus kinopt_world_detach(KinoptWorld *world, const char *name, const double *pose);

/**
 * Moves an obstacle.
 */
KinoptStatus kinopt_world_move(KinoptWorld *world, const char *name, const double *pose);

/**
 * Removes an obstacle.
 */
KinoptStatus kinopt_world_remove(KinoptWorld *world, const char *name);

/**
 * Allows collisions of an obstacle and a link, or of two obstacles.
 */
KinoptStatus kinopt_world_allow_collision(KinoptWorld *world, const char *one, const char *other);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* KINOPT_H */
