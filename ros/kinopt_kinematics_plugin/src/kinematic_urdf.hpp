// URDF text of a robot model's kinematics. Licence: MIT or Apache-2.0.
#pragma once

#include <string>

#include <moveit/robot_model/robot_model.hpp>

namespace kinopt_kinematics_plugin {

/// URDF text with the links and joints of the model, without shapes and masses. Numbers have 17 digits.
///
/// Position limits of the group's joints are those of the robot model, which include joint_limits.yaml.
std::string kinematic_urdf(const urdf::ModelInterface &model, const moveit::core::JointModelGroup &group);

} // namespace kinopt_kinematics_plugin
