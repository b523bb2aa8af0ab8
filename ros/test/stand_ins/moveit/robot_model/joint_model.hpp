// Stand-in for MoveIt's joint model: fixed, revolute and prismatic joints.
#pragma once

#include <string>
#include <vector>

namespace moveit::core {

struct VariableBounds {
  double min_position_ = 0.0;
  double max_position_ = 0.0;
  bool position_bounded_ = false;
};

class JointModel {
public:
  enum JointType { UNKNOWN, REVOLUTE, PRISMATIC, PLANAR, FLOATING, FIXED };
  using Bounds = std::vector<VariableBounds>;

  JointModel(const std::string &name, JointType type) : name_(name), type_(type) {}
  const std::string &getName() const { return name_; }
  JointType getType() const { return type_; }
  size_t getVariableCount() const { return type_ == FIXED ? 0 : type_ == FLOATING ? 7 : type_ == PLANAR ? 3 : 1; }
  const Bounds &getVariableBounds() const { return bounds_; }
  const JointModel *getMimic() const { return mimic_; }
  double getMimicFactor() const { return mimic_factor_; }
  double getMimicOffset() const { return mimic_offset_; }

  void setVariableBounds(double lower, double upper, bool is_bounded = true) { bounds_ = {{lower, upper, is_bounded}}; }
  void setMimic(const JointModel *mimic, double factor, double offset) {
    mimic_ = mimic;
    mimic_factor_ = factor;
    mimic_offset_ = offset;
  }

private:
  std::string name_;
  JointType type_;
  Bounds bounds_;
  const JointModel *mimic_ = nullptr;
  double mimic_factor_ = 1.0;
  double mimic_offset_ = 0.0;
};

} // namespace moveit::core
