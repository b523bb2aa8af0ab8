// Stand-in for rclcpp's logger.
#pragma once

#include <string>

namespace rclcpp {

class Logger {
public:
  explicit Logger(const std::string &name) : name_(name) {}
  const char *get_name() const { return name_.c_str(); }

private:
  std::string name_;
};

inline Logger get_logger(const std::string &name) { return Logger(name); }

} // namespace rclcpp
