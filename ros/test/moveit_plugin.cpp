// Drives the MoveIt plugin through the interface of kinematics::KinematicsBase, as MoveIt does.
#include <algorithm>
#include <cmath>
#include <thread>

#include <moveit/kinematics_base/kinematics_base.hpp>
#include <moveit/robot_model/robot_model.hpp>
#include <moveit/robot_state/robot_state.hpp>
#include <pluginlib/class_list_macros.hpp>

#include "checks.hpp"
#include "reference_kinematics.hpp"

using geometry_msgs::msg::Pose;
using kinematics::KinematicsBase;
using kinematics::KinematicsQueryOptions;
using moveit::core::RobotModel;
using moveit_msgs::msg::MoveItErrorCodes;
using Values = std::vector<double>;
namespace methods = kinematics::DiscretizationMethods;

namespace {

const std::string GROUP = "group";
/// Longer than any search of this test that ends by itself, seconds.
const double LONG = 60.0;
/// Largest error of a solution with the default tolerances, metres and elements of rotation matrices.
const double REACHED = 3e-6;

std::string models;

std::shared_ptr<KinematicsBase> make_plugin() {
  return pluginlib::stand_in::classes<KinematicsBase>().at("kinopt_kinematics_plugin::KinoptKinematicsPlugin")();
}

void set(rclcpp::Node &node, const std::string &name, const rclcpp::Parameter::Value &value) {
  node.declare_parameter("robot_description_kinematics." + GROUP + "." + name, value);
}

Pose message(const Eigen::Isometry3d &placement) {
  const Eigen::Quaterniond rotation(placement.linear());
  Pose pose;
  pose.position = {placement.translation().x(), placement.translation().y(), placement.translation().z()};
  pose.orientation = {rotation.x(), rotation.y(), rotation.z(), rotation.w()};
  return pose;
}

Eigen::Isometry3d placement(const Pose &pose) {
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
  placement.translation() << pose.position.x, pose.position.y, pose.position.z;
  placement.linear() =
      Eigen::Quaterniond(pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z)
          .toRotationMatrix();
  return placement;
}

double error(const Eigen::Isometry3d &a, const Eigen::Isometry3d &b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

double distance(const Values &a, const Values &b) {
  double squares = 0.0;
  for (size_t k = 0; k < a.size(); ++k) squares += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(squares);
}

/// A plugin for a chain of a robot.
struct Chain {
  RobotModel model;
  rclcpp::Node::SharedPtr node = std::make_shared<rclcpp::Node>();
  std::shared_ptr<KinematicsBase> plugin = make_plugin();
  std::string base, tip;

  Chain(const std::string &urdf, const std::string &from, const std::string &to) : model(urdf), base(from), tip(to) {
    model.addGroup(GROUP, base, tip);
  }
  bool initialize() { return plugin->initialize(node, model, GROUP, base, {tip}, 0.1); }

  size_t size() const { return plugin->getJointNames().size(); }
  Positions positions(const Values &values) const {
    Positions all;
    for (size_t k = 0; k < values.size(); ++k) all[plugin->getJointNames()[k]] = values[k];
    return all;
  }
  Eigen::Isometry3d pose(const Values &values) const { return pose(values, tip); }
  Eigen::Isometry3d pose(const Values &values, const std::string &link) const {
    return base_from_link(*model.getURDF(), base, link, positions(values));
  }
  const moveit::core::VariableBounds &bounds(size_t joint) const {
    return model.getJointModelGroup(GROUP)->getJointModel(plugin->getJointNames()[joint])->getVariableBounds()[0];
  }
  /// Configuration within the limits; mimic joints follow their source.
  Values sample(Random &random) const {
    Values values;
    for (size_t k = 0; k < size(); ++k)
      values.push_back(random.between(bounds(k).min_position_, bounds(k).max_position_));
    return followed(values);
  }
  Values followed(Values values) const {
    const auto &names = plugin->getJointNames();
    for (size_t k = 0; k < size(); ++k) {
      const auto *joint = model.getJointModelGroup(GROUP)->getJointModel(names[k]);
      if (!joint->getMimic()) continue;
      for (size_t source = 0; source < size(); ++source) {
        if (names[source] != joint->getMimic()->getName()) continue;
        values[k] = joint->getMimicFactor() * values[source] + joint->getMimicOffset();
      }
    }
    return values;
  }
  Values moved(const Values &from, double largest, Random &random) const {
    Values values = from;
    for (size_t k = 0; k < size(); ++k) {
      values[k] =
          std::clamp(from[k] + random.between(-largest, largest), bounds(k).min_position_, bounds(k).max_position_);
    }
    return followed(values);
  }
  bool is_within_limits(const Values &values) const {
    for (size_t k = 0; k < size(); ++k) {
      const auto &each = bounds(k);
      if (each.position_bounded_ && (values[k] < each.min_position_ || values[k] > each.max_position_)) return false;
    }
    return true;
  }
  /// Checks a solution: its size, limits, mimic joints and pose.
  void check_solution(const Values &solution, const Eigen::Isometry3d &target, const std::string &context) const {
    if (!CHECK_IN(solution.size() == size(), context)) return;
    CHECK_IN(is_within_limits(solution), context);
    CHECK_IN(distance(followed(solution), solution) < 1e-12, context);
    const double off = error(pose(solution), target);
    CHECK_IN(off < REACHED, context + ", error " + std::to_string(off));
  }
};

Chain chain(const std::string &file, const std::string &base, const std::string &tip) {
  return Chain(file_text(models + "/" + file), base, tip);
}
Chain panda() { return chain("franka_panda.urdf", "base", "flange"); }
Chain ur5e() { return chain("universal_ur5e.urdf", "base", "flange"); }

const Values PANDA_SEED = {0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8};
const Values PANDA_TARGET = {0.4, -0.2, 0.1, -1.8, 0.2, 1.7, 0.5};
const Values UR5E_SEED = {0.0, -1.5, 1.5, -1.5, -1.5, 0.0};
const Values UR5E_TARGET = {0.5, -1.0, 1.2, -0.9, 1.1, 0.3};

/// A robot whose second joint follows the first, and whose fourth joint is beyond the tip.
const char *const MIMIC_ROBOT = R"(<robot name="mimic">
  <link name="base"/><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
  <joint name="first" type="revolute"><parent link="base"/><child link="a"/>
    <origin xyz="0 0 0.1" rpy="0 1.5707963267948966 0.3"/>
    <axis xyz="0 0 1"/><limit lower="-1.5" upper="1.5" effort="1" velocity="1"/></joint>
  <joint name="second" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0.3 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
    <mimic joint="first" multiplier="-0.5" offset="0.1"/></joint>
  <joint name="third" type="prismatic"><parent link="b"/><child link="c"/><origin xyz="0.3 0 0" rpy="0.1 -1.5707 0"/>
    <axis xyz="0 0 1"/><limit lower="-0.2" upper="0.2" effort="1" velocity="1"/></joint>
  <joint name="fourth" type="revolute"><parent link="c"/><child link="d"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>)";

// ---- initialize ----

void initialization() {
  Chain arm = panda();
  CHECK(arm.initialize());
  CHECK(rclcpp::stand_in::last_info.find(GROUP) != std::string::npos);
  CHECK(arm.plugin->getJointNames() ==
        (std::vector<std::string>{"joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "joint7"}));
  CHECK(arm.plugin->getLinkNames() == std::vector<std::string>{"flange"});
  CHECK(arm.plugin->getTipFrame() == "flange" && arm.plugin->getBaseFrame() == "base");
  CHECK(arm.plugin->getGroupName() == GROUP);
  // The names of MoveIt 1 with a slash.
  CHECK(arm.plugin->initialize(arm.node, arm.model, GROUP, "/base", {"/flange"}, 0.1));

  const auto fails = [](Chain &arm, const char *group, const std::string &base, const std::vector<std::string> &tips) {
    const int errors = rclcpp::stand_in::error_count;
    return !arm.plugin->initialize(arm.node, arm.model, group, base, tips, 0.1) &&
           rclcpp::stand_in::error_count > errors;
  };
  CHECK(fails(arm, "other", "base", {"flange"}));
  CHECK(fails(arm, "group", "elbow", {"flange"}));
  CHECK(fails(arm, "group", "base", {"elbow"}));
  CHECK(fails(arm, "group", "base", {"flange", "hand"}));
  CHECK(fails(arm, "group", "base", {}));
  CHECK(fails(arm, "group", "flange", {"hand"})); // Nothing moves.
  arm.model.addGroup("upper", "base", "link4");
  CHECK(fails(arm, "upper", "base", {"flange"})); // The wrist is not in the group.
  arm.model.addGroup("tree", "base", "flange", false);
  CHECK(fails(arm, "tree", "base", {"flange"}));
  std::string reason;
  CHECK(!arm.plugin->supportsGroup(arm.model.getJointModelGroup("tree"), &reason) && !reason.empty());
  CHECK(!arm.plugin->supportsGroup(arm.model.getJointModelGroup("tree")));
  CHECK(arm.plugin->supportsGroup(arm.model.getJointModelGroup(GROUP)));

  // A plugin that is not initialized, or no longer.
  Values solution;
  MoveItErrorCodes code;
  std::vector<Pose> poses;
  for (const auto &plugin : {make_plugin(), arm.plugin}) {
    CHECK(!plugin->searchPositionIK(Pose(), PANDA_SEED, 1.0, solution, code));
    CHECK(code.val == MoveItErrorCodes::NO_IK_SOLUTION);
    CHECK(!plugin->getPositionFK({"flange"}, PANDA_SEED, poses));
    std::vector<Values> solutions;
    kinematics::KinematicsResult result;
    CHECK(!plugin->getPositionIK({Pose()}, PANDA_SEED, solutions, result, KinematicsQueryOptions()));
    CHECK(result.kinematic_error == kinematics::KinematicErrors::SOLVER_NOT_ACTIVE);
  }
}

void parameters() {
  for (const auto &[name, value] :
       std::vector<std::pair<std::string, rclcpp::Parameter::Value>>{{"position_tolerance", "small"},
                                                                     {"position_tolerance", -1.0},
                                                                     {"search", "best"},
                                                                     {"max_solutions", int64_t{0}}}) {
    Chain arm = panda();
    set(*arm.node, name, value);
    CHECK_IN(!arm.initialize(), name);
  }
  // Defaults are declared.
  Chain arm = panda();
  CHECK(arm.initialize());
  CHECK(arm.node->get_parameter("robot_description_kinematics.group.max_solutions").get_value<int64_t>() == 16);

  // Only the position counts.
  Chain pointing = ur5e();
  set(*pointing.node, "position_only_ik", true);
  CHECK(pointing.initialize());
  Eigen::Isometry3d target = pointing.pose(UR5E_TARGET);
  const Eigen::Vector3d position = target.translation();
  target.linear() = Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitX()).toRotationMatrix() * target.linear();
  Values solution;
  MoveItErrorCodes code;
  CHECK(pointing.plugin->searchPositionIK(message(target), UR5E_SEED, LONG, solution, code));
  CHECK((pointing.pose(solution).translation() - position).norm() < REACHED);

  // A looser tolerance, a search and a number of attempts are used.
  Chain loose = panda();
  set(*loose.node, "position_tolerance", 1e-2);
  set(*loose.node, "orientation_tolerance", 1e-2);
  set(*loose.node, "search", "nearest");
  set(*loose.node, "attempts", int64_t{10});
  set(*loose.node, "seed", int64_t{3});
  CHECK(loose.initialize());
  CHECK(loose.plugin->searchPositionIK(message(loose.pose(PANDA_TARGET)), PANDA_SEED, LONG, solution, code));
  CHECK(error(loose.pose(solution), loose.pose(PANDA_TARGET)) < 2e-2);
}

// ---- every overload, on several robots ----

void forward_kinematics(const Chain &arm, Random &random, const std::string &name) {
  std::vector<std::string> links = arm.model.getJointModelGroup(GROUP)->getLinkModelNames();
  links.push_back(arm.base);
  for (int k = 0; k < 20; ++k) {
    const Values values = arm.sample(random);
    std::vector<Pose> poses;
    if (!CHECK_IN(arm.plugin->getPositionFK(links, values, poses), name)) return;
    CHECK_IN(poses.size() == links.size(), name);
    for (size_t link = 0; link < links.size(); ++link) {
      CHECK_IN(error(placement(poses[link]), arm.pose(values, links[link])) < 1e-12, name + " " + links[link]);
    }
  }
  std::vector<Pose> poses;
  Values longer(arm.size() + 1, 0.0);
  CHECK(!arm.plugin->getPositionFK({arm.tip}, longer, poses));
  CHECK(!arm.plugin->getPositionFK({"elsewhere"}, Values(arm.size(), 0.0), poses));
  CHECK(!arm.plugin->getPositionFK({arm.tip}, Values(arm.size(), std::nan("")), poses));
}

void inverse_kinematics(const Chain &arm, Random &random, const std::string &name) {
  const KinematicsBase &plugin = *arm.plugin;
  const KinematicsQueryOptions options;
  const Values none;
  int calls = 0;
  const auto callback = [&](const Pose &, const Values &, MoveItErrorCodes &code) {
    ++calls;
    code.val = MoveItErrorCodes::SUCCESS;
  };
  for (int k = 0; k < 25; ++k) {
    const Values q = arm.sample(random), seed = arm.moved(q, 0.3, random);
    const Eigen::Isometry3d target = arm.pose(q);
    const Pose pose = message(target);
    const Values limits(arm.size(), 0.6);
    const auto is_found = [&](bool found, const Values &solution, const MoveItErrorCodes &code, const char *overload) {
      const std::string context = name + ", " + overload + ", target " + std::to_string(k);
      if (!CHECK_IN(found, context)) return;
      CHECK_IN(code.val == MoveItErrorCodes::SUCCESS, context);
      arm.check_solution(solution, target, context);
    };
    Values solution;
    MoveItErrorCodes code;
    bool found = plugin.searchPositionIK(pose, seed, LONG, solution, code);
    is_found(found, solution, code, "timeout");
    found = plugin.searchPositionIK(pose, arm.sample(random), LONG, solution, code);
    is_found(found, solution, code, "random seed");
    found = plugin.searchPositionIK(pose, seed, LONG, limits, solution, code);
    is_found(found, solution, code, "limits");
    const int calls_before = calls;
    found = plugin.searchPositionIK(pose, seed, LONG, solution, callback, code);
    is_found(found, solution, code, "callback");
    found = plugin.searchPositionIK(pose, seed, LONG, limits, solution, callback, code);
    is_found(found, solution, code, "limits and callback");
    found = plugin.searchPositionIK(std::vector<Pose>{pose}, seed, LONG, limits, solution, callback, code, options,
                                    nullptr);
    is_found(found, solution, code, "poses");
    CHECK_IN(calls == calls_before + 3, name);
    found = plugin.searchPositionIK(std::vector<Pose>{pose}, seed, LONG, none, solution, nullptr,
                                    KinematicsBase::IKCostFn(), code, options, nullptr);
    is_found(found, solution, code, "no cost function");
    found = plugin.getPositionIK(pose, seed, solution, code);
    if (found) is_found(found, solution, code, "single attempt");
    std::vector<Values> solutions;
    kinematics::KinematicsResult result;
    CHECK_IN(plugin.getPositionIK({pose}, seed, solutions, result, options), name);
    CHECK_IN(result.kinematic_error == kinematics::KinematicErrors::OK && result.solution_percentage == 1.0, name);
    for (size_t one = 0; one < solutions.size(); ++one) {
      arm.check_solution(solutions[one], target, name + ", several solutions");
      for (size_t other = 0; other < one; ++other) CHECK_IN(distance(solutions[one], solutions[other]) > 0.1, name);
      if (one > 0) CHECK_IN(distance(solutions[one], seed) >= distance(solutions[one - 1], seed) - 1e-12, name);
    }
  }
  // From the target's own configuration a single attempt suffices, and stays there.
  for (int k = 0; k < 25; ++k) {
    const Values q = arm.sample(random);
    Values solution;
    MoveItErrorCodes code;
    CHECK_IN(plugin.getPositionIK(message(arm.pose(q)), q, solution, code), name);
    CHECK_IN(code.val == MoveItErrorCodes::SUCCESS && distance(solution, q) < 1e-4, name);
  }
}

void robots() {
  struct Case {
    const char *file, *base, *tip;
  };
  for (const Case &each :
       {Case{"franka_panda.urdf", "base", "flange"}, Case{"franka_panda.urdf", "base", "tool"},
        Case{"franka_panda.urdf", "link1", "link7"}, Case{"universal_ur5e.urdf", "base", "flange"},
        Case{"universal_ur10e.urdf", "base", "flange"}, Case{"kuka_iiwa14.urdf", "base", "flange"},
        Case{"rethink_baxter.urdf", "torso", "left_tool"},
        Case{"robotstudio_so101.urdf", "base_link", "gripper_frame_link"},
        Case{"aldebaran_nao.urdf", "torso", "right_hand"}, Case{"adept_cobra_s600.urdf", "base", "flange"}}) {
    Chain arm = chain(each.file, each.base, each.tip);
    const std::string name = std::string(each.file) + " to " + each.tip;
    if (!CHECK_IN(arm.initialize(), name + ": " + rclcpp::stand_in::last_error)) continue;
    Random random;
    forward_kinematics(arm, random, name);
    inverse_kinematics(arm, random, name);
  }
}

// ---- the callback inside the search ----

void callback_rejects_the_first_solutions() {
  Chain arm = panda();
  CHECK(arm.initialize());
  const Eigen::Isometry3d target = arm.pose(PANDA_TARGET);
  for (size_t rejected : {1, 7, 300}) {
    std::vector<Values> offered;
    const auto callback = [&](const Pose &pose, const Values &values, MoveItErrorCodes &code) {
      CHECK(error(placement(pose), target) < 1e-12);
      offered.push_back(values);
      code.val = offered.size() > rejected ? MoveItErrorCodes::SUCCESS : MoveItErrorCodes::GOAL_IN_COLLISION;
    };
    Values solution;
    MoveItErrorCodes code;
    CHECK(arm.plugin->searchPositionIK(message(target), PANDA_SEED, LONG, solution, callback, code));
    CHECK(code.val == MoveItErrorCodes::SUCCESS);
    CHECK(offered.size() == rejected + 1 && solution == offered.back());
    for (size_t k = 0; k < offered.size(); ++k) {
      arm.check_solution(offered[k], target, "offered");
      // Coarse at first, then finer.
      const double apart = k < 20 ? 0.1 : 1e-3;
      for (size_t other = 0; other < k; ++other) CHECK(distance(offered[k], offered[other]) > apart);
    }
  }
}

void callback_accepts_one_elbow_only() {
  Chain arm = ur5e();
  CHECK(arm.initialize());
  Random random;
  for (int k = 0; k < 50; ++k) {
    // A target that the arm reaches with its elbow bent to one side also has solutions with the other.
    const Eigen::Isometry3d target = arm.pose(arm.sample(random));
    const Values seed = arm.sample(random);
    for (const double side : {1.0, -1.0}) {
      const auto callback = [&](const Pose &, const Values &values, MoveItErrorCodes &code) {
        const double elbow = std::remainder(values[2], 2.0 * M_PI);
        code.val = side * elbow > 0.0 ? MoveItErrorCodes::SUCCESS : MoveItErrorCodes::NO_IK_SOLUTION;
      };
      Values solution;
      MoveItErrorCodes code;
      const std::string context = "target " + std::to_string(k);
      if (!CHECK_IN(arm.plugin->searchPositionIK(message(target), seed, LONG, solution, callback, code), context))
        continue;
      CHECK_IN(side * std::remainder(solution[2], 2.0 * M_PI) > 0.0, context);
      arm.check_solution(solution, target, context);
    }
  }
}

void callback_that_rejects_all() {
  const auto reject = [](const Pose &, const Values &, MoveItErrorCodes &code) {
    code.val = MoveItErrorCodes::GOAL_IN_COLLISION;
  };
  // Six joints have finitely many solutions: the search ends before its timeout.
  Chain finite = ur5e();
  CHECK(finite.initialize());
  Values solution = {1.0};
  MoveItErrorCodes code;
  CHECK(!finite.plugin->searchPositionIK(message(finite.pose(UR5E_TARGET)), UR5E_SEED, LONG, solution, reject, code));
  CHECK(code.val == MoveItErrorCodes::NO_IK_SOLUTION);
  CHECK(solution == Values{1.0});
  // Seven joints have infinitely many: the search ends by its timeout.
  Chain redundant = panda();
  CHECK(redundant.initialize());
  for (const double timeout : {1e-9, 0.005, 0.2}) {
    CHECK(!redundant.plugin->searchPositionIK(message(redundant.pose(PANDA_TARGET)), PANDA_SEED, timeout, solution,
                                              reject, code));
    CHECK_IN(code.val == MoveItErrorCodes::TIMED_OUT, std::to_string(timeout));
  }
  // An exception of the callback reaches the caller.
  const auto fail = [](const Pose &, const Values &, MoveItErrorCodes &) { throw std::domain_error("callback"); };
  bool thrown = false;
  try {
    redundant.plugin->searchPositionIK(message(redundant.pose(PANDA_TARGET)), PANDA_SEED, LONG, solution, fail, code);
  } catch (const std::domain_error &) {
    thrown = true;
  }
  CHECK(thrown);
}

void cost_function() {
  Chain arm = panda();
  CHECK(arm.initialize());
  const Eigen::Isometry3d target = arm.pose(PANDA_TARGET);
  std::vector<double> costs;
  const auto cost = [&](const Pose &, const moveit::core::RobotState &state, const moveit::core::JointModelGroup *group,
                        const Values &seed) {
    CHECK(group->getName() == GROUP && seed == PANDA_SEED);
    costs.push_back(std::abs(state.position("joint1") - 1.0));
    return costs.back();
  };
  const auto callback = [](const Pose &, const Values &values, MoveItErrorCodes &code) {
    code.val = values[0] > 0.0 ? MoveItErrorCodes::SUCCESS : MoveItErrorCodes::NO_IK_SOLUTION;
  };
  Values solution;
  MoveItErrorCodes code;
  const std::vector<Pose> poses = {message(target)};
  CHECK(arm.plugin->searchPositionIK(poses, PANDA_SEED, LONG, {}, solution, callback, cost, code));
  CHECK(code.val == MoveItErrorCodes::SUCCESS);
  arm.check_solution(solution, target, "cost");
  CHECK(costs.size() == 16 && solution[0] > 0.0);
  CHECK(std::abs(solution[0] - 1.0) == *std::min_element(costs.begin(), costs.end()));
  const moveit::core::RobotState state(std::shared_ptr<const RobotModel>(&arm.model, [](const RobotModel *) {}));
  CHECK(arm.plugin->searchPositionIK(poses, PANDA_SEED, LONG, {}, solution, nullptr, cost, code,
                                     KinematicsQueryOptions(), &state));
  arm.check_solution(solution, target, "cost with a state");
  const auto reject = [](const Pose &, const Values &, MoveItErrorCodes &code) {
    code.val = MoveItErrorCodes::NO_IK_SOLUTION;
  };
  CHECK(!arm.plugin->searchPositionIK(poses, PANDA_SEED, 0.05, {}, solution, reject, cost, code));
  CHECK(code.val != MoveItErrorCodes::SUCCESS);
}

// ---- limits ----

void consistency_limits() {
  for (Chain (*make)() : {panda, ur5e}) {
    Chain arm = make();
    CHECK(arm.initialize());
    Random random;
    int found_count = 0;
    for (int k = 0; k < 100; ++k) {
      const Values seed = arm.sample(random);
      Values limits, q = seed;
      for (size_t joint = 0; joint < arm.size(); ++joint) {
        limits.push_back(random.between(0.0, 0.5));
        // Targets at the limits of their joints too.
        const double side = random.between(-1.0, 1.0) > 0.0 ? 1.0 : random.between(-1.0, 1.0);
        q[joint] = std::clamp(seed[joint] + side * limits[joint], arm.bounds(joint).min_position_,
                              arm.bounds(joint).max_position_);
      }
      Values solution;
      MoveItErrorCodes code;
      const bool is_far = k % 2 == 1;
      const Eigen::Isometry3d target = arm.pose(is_far ? arm.sample(random) : q);
      if (!arm.plugin->searchPositionIK(message(target), seed, LONG, limits, solution, code)) {
        CHECK(code.val == MoveItErrorCodes::NO_IK_SOLUTION);
        continue;
      }
      if (!is_far) ++found_count;
      arm.check_solution(solution, target, "consistency");
      for (size_t joint = 0; joint < arm.size(); ++joint)
        CHECK(std::abs(solution[joint] - seed[joint]) <= limits[joint]);
    }
    CHECK_IN(found_count >= 49, std::to_string(found_count));

    // A seed outside the joint limits by more than its consistency limit has no solution.
    Values seed = arm.size() == 7 ? PANDA_SEED : UR5E_SEED, solution;
    const Eigen::Isometry3d target = arm.pose(seed);
    seed[0] = arm.bounds(0).max_position_ + 0.2;
    MoveItErrorCodes code;
    Values limits(arm.size(), 100.0);
    limits[0] = 0.1;
    CHECK(!arm.plugin->searchPositionIK(message(target), seed, LONG, limits, solution, code));
    CHECK(arm.plugin->searchPositionIK(message(target), seed, LONG, solution, code));
    CHECK(!arm.plugin->searchPositionIK(message(target), seed, LONG, Values(arm.size(), -1.0), solution, code));
    CHECK(code.val == MoveItErrorCodes::NO_IK_SOLUTION);
  }
}

void limits_of_the_robot_model() {
  Chain arm = panda();
  arm.model.joint("joint4").setVariableBounds(-2.1, -1.7); // As joint_limits.yaml does.
  CHECK(arm.initialize());
  Random random;
  for (int k = 0; k < 30; ++k) {
    const Values q = arm.sample(random);
    Values solution;
    MoveItErrorCodes code;
    CHECK(arm.plugin->searchPositionIK(message(arm.pose(q)), arm.sample(random), LONG, solution, code));
    CHECK(solution[3] >= -2.1 && solution[3] <= -1.7);
    arm.check_solution(solution, arm.pose(q), "narrower limits");
  }
}

void redundant_joints() {
  Chain arm = panda();
  CHECK(arm.initialize());
  CHECK(!arm.plugin->setRedundantJoints(std::vector<unsigned int>{7}));
  CHECK(arm.plugin->setRedundantJoints(std::vector<std::string>{"joint3"}));
  Random random;
  KinematicsQueryOptions locked;
  locked.lock_redundant_joints = true;
  for (int k = 0; k < 50; ++k) {
    const Values q = arm.sample(random);
    Values seed = arm.sample(random);
    seed[2] = q[2];
    Values solution;
    MoveItErrorCodes code;
    const Eigen::Isometry3d target = arm.pose(q);
    const std::string context = "target " + std::to_string(k);
    CHECK_IN(arm.plugin->searchPositionIK(message(target), seed, LONG, solution, code, locked), context);
    arm.check_solution(solution, target, context);
    CHECK_IN(solution[2] == seed[2], context);

    std::vector<Values> held, free;
    kinematics::KinematicsResult result;
    KinematicsQueryOptions options;
    CHECK_IN(arm.plugin->getPositionIK({message(target)}, seed, held, result, options), context);
    for (const Values &each : held) CHECK_IN(each[2] == seed[2], context);
    options.discretization_method = methods::ALL_RANDOM_SAMPLED;
    CHECK_IN(arm.plugin->getPositionIK({message(target)}, seed, free, result, options), context);
    bool is_moved = false;
    for (const Values &each : free) is_moved |= each[2] != seed[2];
    CHECK_IN(is_moved && free.size() > 1, context);
    options.discretization_method = methods::ALL_DISCRETIZED;
    CHECK_IN(!arm.plugin->getPositionIK({message(target)}, seed, free, result, options), context);
    CHECK_IN(result.kinematic_error == kinematics::KinematicErrors::UNSUPORTED_DISCRETIZATION_REQUESTED, context);
  }
}

// ---- misses and wrong arguments ----

void unreachable() {
  for (Chain (*make)() : {panda, ur5e}) {
    Chain arm = make();
    CHECK(arm.initialize());
    const Values seed = arm.size() == 7 ? PANDA_SEED : UR5E_SEED;
    Eigen::Isometry3d target = arm.pose(seed);
    target.translation().x() += 5.0;
    Values solution = {1.0};
    MoveItErrorCodes code;
    const auto never = [](const Pose &, const Values &, MoveItErrorCodes &) { CHECK(false); };
    CHECK(!arm.plugin->searchPositionIK(message(target), seed, LONG, solution, never, code));
    CHECK(code.val == MoveItErrorCodes::NO_IK_SOLUTION && solution == Values{1.0});
    CHECK(!arm.plugin->getPositionIK(message(target), seed, solution, code));
    CHECK(code.val == MoveItErrorCodes::NO_IK_SOLUTION);
    std::vector<Values> solutions = {{1.0}};
    kinematics::KinematicsResult result;
    CHECK(!arm.plugin->getPositionIK({message(target)}, seed, solutions, result, KinematicsQueryOptions()));
    CHECK(result.kinematic_error == kinematics::KinematicErrors::NO_SOLUTION && solutions.empty());

    // The closest pose: stretched towards the target.
    KinematicsQueryOptions approximate;
    approximate.return_approximate_solution = true;
    CHECK(arm.plugin->searchPositionIK(message(target), seed, LONG, solution, code, approximate));
    CHECK(code.val == MoveItErrorCodes::SUCCESS && arm.is_within_limits(solution));
    CHECK(arm.pose(solution).translation().x() > arm.pose(seed).translation().x());
    const auto reject = [](const Pose &, const Values &, MoveItErrorCodes &code) {
      code.val = MoveItErrorCodes::NO_IK_SOLUTION;
    };
    CHECK(!arm.plugin->searchPositionIK(message(target), seed, LONG, solution, reject, code, approximate));
  }
}

void wrong_arguments() {
  Chain arm = panda();
  CHECK(arm.initialize());
  const Pose pose = message(arm.pose(PANDA_TARGET));
  Values solution;
  MoveItErrorCodes code;
  const auto is_refused = [&](bool found) {
    const bool refused = !found && code.val == MoveItErrorCodes::NO_IK_SOLUTION;
    code.val = MoveItErrorCodes::SUCCESS;
    return refused;
  };
  const Values six(6, 0.0), none, seven(7, 0.1);
  CHECK(is_refused(arm.plugin->getPositionIK(pose, six, solution, code)));
  CHECK(is_refused(arm.plugin->searchPositionIK(pose, none, 1.0, solution, code)));
  CHECK(is_refused(arm.plugin->searchPositionIK(pose, PANDA_SEED, 1.0, six, solution, code)));
  CHECK(is_refused(arm.plugin->searchPositionIK(pose, Values(7, std::nan("")), 1.0, solution, code)));
  CHECK(is_refused(arm.plugin->searchPositionIK(pose, PANDA_SEED, 1.0, Values(7, std::nan("")), solution, code)));
  Pose zero = pose, infinite = pose;
  zero.orientation = {0.0, 0.0, 0.0, 0.0};
  infinite.position.x = INFINITY;
  CHECK(is_refused(arm.plugin->searchPositionIK(zero, PANDA_SEED, 1.0, solution, code)));
  CHECK(is_refused(arm.plugin->searchPositionIK(infinite, PANDA_SEED, 1.0, solution, code)));
  CHECK(is_refused(arm.plugin->searchPositionIK({pose, pose}, PANDA_SEED, 1.0, none, solution, nullptr, code)));
  CHECK(is_refused(arm.plugin->searchPositionIK(std::vector<Pose>{}, PANDA_SEED, 1.0, none, solution, nullptr, code)));
  // A quaternion of another length is a rotation too.
  Pose longer = pose;
  longer.orientation = {2 * pose.orientation.x, 2 * pose.orientation.y, 2 * pose.orientation.z, 2 * pose.orientation.w};
  CHECK(arm.plugin->searchPositionIK(longer, PANDA_SEED, LONG, solution, code));
  arm.check_solution(solution, arm.pose(PANDA_TARGET), "longer quaternion");

  std::vector<Values> solutions;
  kinematics::KinematicsResult result;
  const KinematicsQueryOptions options;
  CHECK(!arm.plugin->getPositionIK(std::vector<Pose>{}, PANDA_SEED, solutions, result, options));
  CHECK(result.kinematic_error == kinematics::KinematicErrors::EMPTY_TIP_POSES);
  CHECK(!arm.plugin->getPositionIK({pose, pose}, PANDA_SEED, solutions, result, options));
  CHECK(result.kinematic_error == kinematics::KinematicErrors::MULTIPLE_TIPS_NOT_SUPPORTED);
  CHECK(!arm.plugin->getPositionIK({pose}, six, solutions, result, options));
  CHECK(result.kinematic_error == kinematics::KinematicErrors::NO_SOLUTION);
}

// ---- chains ----

void several_solutions() {
  Chain arm = ur5e();
  set(*arm.node, "max_solutions", int64_t{1000});
  CHECK(arm.initialize());
  std::vector<Values> solutions;
  kinematics::KinematicsResult result;
  CHECK(arm.plugin->getPositionIK({message(arm.pose(UR5E_TARGET))}, UR5E_SEED, solutions, result,
                                  KinematicsQueryOptions()));
  // The closed form of a UR5e has eight solutions.
  CHECK_IN(solutions.size() == 8, std::to_string(solutions.size()));
}

void model_frame_as_base() {
  RobotModel model(file_text(models + "/franka_panda.urdf"), "world");
  model.addGroup(GROUP, "base", "flange");
  const auto node = std::make_shared<rclcpp::Node>();
  auto plugin = make_plugin();
  CHECK(plugin->initialize(node, model, GROUP, "world", {"flange"}, 0.1));
  CHECK(plugin->getBaseFrame() == "world");
  std::vector<Pose> poses;
  CHECK(plugin->getPositionFK({"flange"}, PANDA_SEED, poses));
  Chain arm = panda();
  CHECK(arm.initialize());
  CHECK(error(placement(poses[0]), arm.pose(PANDA_SEED)) < 1e-12);
  RobotModel floating(file_text(models + "/franka_panda.urdf"), "world", moveit::core::JointModel::FLOATING);
  floating.addGroup(GROUP, "base", "flange");
  CHECK(!plugin->initialize(node, floating, GROUP, "world", {"flange"}, 0.1));
}

void mimic_joints() {
  Chain arm(MIMIC_ROBOT, "base", "c");
  CHECK(arm.initialize());
  CHECK(arm.plugin->getJointNames() == (std::vector<std::string>{"first", "second", "third"}));
  Random random;
  forward_kinematics(arm, random, "mimic robot");
  inverse_kinematics(arm, random, "mimic robot");

  // A joint of the group beyond the tip keeps its seed.
  Chain longer(MIMIC_ROBOT, "base", "d");
  CHECK(longer.plugin->initialize(longer.node, longer.model, GROUP, "base", {"c"}, 0.1));
  CHECK(longer.plugin->getJointNames().size() == 4);
  const Values q = longer.followed({0.3, 0.0, 0.1, 0.7});
  Values solution;
  MoveItErrorCodes code;
  CHECK(longer.plugin->searchPositionIK(message(longer.pose(q, "c")), {0.1, 0.05, 0.0, 0.7}, LONG, solution, code));
  CHECK(distance(solution, q) < 1e-4 && solution[3] == 0.7);
}

void continuous_joints() {
  std::string urdf = file_text(models + "/franka_panda.urdf");
  const std::string limited = "\"joint1\" type=\"revolute\"";
  const size_t at = urdf.find(limited);
  if (!CHECK(at != std::string::npos)) return;
  urdf.replace(at, limited.size(), "\"joint1\" type=\"continuous\"");
  Chain arm(urdf, "base", "flange");
  CHECK(arm.initialize());
  Random random;
  forward_kinematics(arm, random, "continuous joint");
  inverse_kinematics(arm, random, "continuous joint");
  // A small step across the end of MoveIt's range stays small.
  Values seed = PANDA_SEED, q = PANDA_SEED, solution;
  seed[0] = M_PI - 0.01;
  q[0] = -M_PI + 0.01;
  MoveItErrorCodes code;
  CHECK(arm.plugin->searchPositionIK(message(arm.pose(q)), seed, LONG, Values(7, 0.1), solution, code));
  arm.check_solution(solution, arm.pose(q), "across");
}

void threads() {
  Chain arm = panda();
  CHECK(arm.initialize());
  std::vector<int> found(4, 0);
  std::vector<std::thread> running;
  for (size_t thread = 0; thread < found.size(); ++thread) {
    running.emplace_back([&, thread] {
      for (int k = 0; k < 50; ++k) {
        Values q = PANDA_TARGET, solution;
        q[0] += 0.01 * k + 0.001 * static_cast<double>(thread);
        MoveItErrorCodes code;
        std::vector<Pose> poses;
        const bool is_found = arm.plugin->searchPositionIK(message(arm.pose(q)), PANDA_SEED, LONG, solution, code) &&
                              arm.plugin->getPositionFK({"flange"}, solution, poses);
        if (is_found && error(placement(poses[0]), arm.pose(q)) < REACHED) ++found[thread];
      }
    });
  }
  for (std::thread &each : running) each.join();
  for (int count : found) CHECK(count == 50);
}

} // namespace

int main(int count, char **arguments) {
  models = count > 1 ? arguments[1] : "models";
  const std::vector<std::pair<const char *, void (*)()>> tests = {
      {"initialization", initialization},
      {"parameters", parameters},
      {"robots", robots},
      {"callback_rejects_the_first_solutions", callback_rejects_the_first_solutions},
      {"callback_accepts_one_elbow_only", callback_accepts_one_elbow_only},
      {"callback_that_rejects_all", callback_that_rejects_all},
      {"cost_function", cost_function},
      {"consistency_limits", consistency_limits},
      {"limits_of_the_robot_model", limits_of_the_robot_model},
      {"redundant_joints", redundant_joints},
      {"unreachable", unreachable},
      {"wrong_arguments", wrong_arguments},
      {"several_solutions", several_solutions},
      {"model_frame_as_base", model_frame_as_base},
      {"mimic_joints", mimic_joints},
      {"continuous_joints", continuous_joints},
      {"threads", threads},
  };
  for (const auto &[name, test] : tests) {
    const int before = failures;
    test();
    std::cout << (failures == before ? "passed " : "FAILED ") << name << std::endl;
  }
  return failures == 0 ? 0 : 1;
}
