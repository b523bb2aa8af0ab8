// URDF text of a robot model's kinematics. Licence: MIT or Apache-2.0.
#include "kinematic_urdf.hpp"

#include <cmath>
#include <cstdio>

#include <Eigen/Geometry>
#include <urdf_model/model.h>

namespace kinopt_kinematics_plugin {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string numbers(double x, double y, double z) { return number(x) + " " + number(y) + " " + number(z); }

std::string attribute(const std::string &name, const std::string &value) {
  std::string text = " " + name + "=\"";
  for (char each : value) {
    switch (each) {
    case '&': text += "&amp;"; break;
    case '<': text += "&lt;"; break;
    case '"': text += "&quot;"; break;
    default: text += each;
    }
  }
  return text + "\"";
}

/// Roll, pitch and yaw.
///
/// The roll is computed after undoing the yaw, so that their product is exact near a pitch of a quarter turn too.
Eigen::Vector3d roll_pitch_yaw(const urdf::Rotation &rotation) {
  const Eigen::Matrix3d r =
      Eigen::Quaterniond(rotation.w, rotation.x, rotation.y, rotation.z).normalized().toRotationMatrix();
  const double yaw = std::atan2(r(1, 0), r(0, 0));
  const double sine = std::sin(yaw), cosine = std::cos(yaw);
  const double pitch = std::atan2(-r(2, 0), cosine * r(0, 0) + sine * r(1, 0));
  const double roll = std::atan2(sine * r(0, 2) - cosine * r(1, 2), cosine * r(1, 1) - sine * r(0, 1));
  return {roll, pitch, yaw};
}

const char *type_name(int type) {
  switch (type) {
  case urdf::Joint::REVOLUTE: return "revolute";
  case urdf::Joint::CONTINUOUS: return "continuous";
  case urdf::Joint::PRISMATIC: return "prismatic";
  case urdf::Joint::FLOATING: return "floating";
  case urdf::Joint::PLANAR: return "planar";
  default: return "fixed";
  }
}

std::string limit(const urdf::Joint &joint, const moveit::core::JointModelGroup &group) {
  if (!joint.limits) return "";
  double lower = joint.limits->lower, upper = joint.limits->upper;
  if (group.hasJointModel(joint.name)) {
    const auto &bounds = group.getJointModel(joint.name)->getVariableBounds();
    if (bounds.size() == 1 && bounds[0].position_bounded_) {
      lower = bounds[0].min_position_;
      upper = bounds[0].max_position_;
    }
  }
  return "<limit" + attribute("lower", number(lower)) + attribute("upper", number(upper)) +
         attribute("effort", number(joint.limits->effort)) + attribute("velocity", number(joint.limits->velocity)) +
         "/>";
}

std::string element(const urdf::Joint &joint, const moveit::core::JointModelGroup &group) {
  const urdf::Pose &origin = joint.parent_to_joint_origin_transform;
  const Eigen::Vector3d rpy = roll_pitch_yaw(origin.rotation);
  std::string text = "<joint" + attribute("name", joint.name) + attribute("type", type_name(joint.type)) + ">";
  text += "<parent" + attribute("link", joint.parent_link_name) + "/>";
  text += "<child" + attribute("link", joint.child_link_name) + "/>";
  text += "<origin" + attribute("xyz", numbers(origin.position.x, origin.position.y, origin.position.z)) +
          attribute("rpy", numbers(rpy.x(), rpy.y(), rpy.z())) + "/>";
  if (joint.type != urdf::Joint::FIXED && joint.type != urdf::Joint::FLOATING) {
    text += "<axis" + attribute("xyz", numbers(joint.axis.x, joint.axis.y, joint.axis.z)) + "/>";
  }
  if (joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::PRISMATIC) text += limit(joint, group);
  if (joint.mimic) {
    text += "<mimic" + attribute("joint", joint.mimic->joint_name) +
            attribute("multiplier", number(joint.mimic->multiplier)) +
            attribute("offset", number(joint.mimic->offset)) + "/>";
  }
  return text + "</joint>\n";
}

} // namespace

std::string kinematic_urdf(const urdf::ModelInterface &model, const moveit::core::JointModelGroup &group) {
  std::string text = "<robot" + attribute("name", model.getName()) + ">\n";
  for (const auto &[name, link] : model.links_) text += "<link" + attribute("name", name) + "/>\n";
  for (const auto &[name, joint] : model.joints_) text += element(*joint, group);
  return text + "</robot>\n";
}

} // namespace kinopt_kinematics_plugin
