// Stand-in for rclcpp's parameters: a value with a fixed type.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <variant>

namespace rclcpp {

class ParameterTypeException : public std::runtime_error {
public:
  explicit ParameterTypeException(const std::string &name)
      : std::runtime_error("parameter '" + name + "' has invalid type") {}
};

class Parameter {
public:
  using Value = std::variant<std::monostate, bool, int64_t, double, std::string>;

  Parameter() = default;
  Parameter(const std::string &name, Value value) : name_(name), value_(std::move(value)) {}

  template <class T> T get_value() const {
    if (const T *value = std::get_if<T>(&value_)) return *value;
    throw ParameterTypeException(name_);
  }
  double as_double() const { return get_value<double>(); }
  std::string as_string() const { return get_value<std::string>(); }

private:
  std::string name_;
  Value value_;
};

} // namespace rclcpp
