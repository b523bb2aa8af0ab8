// Checks of a driving test: each failure prints its line.
#pragma once

#include <fstream>
#include <iostream>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

inline int failures = 0;

inline bool check(bool condition, const char *text, const char *file, int line, const std::string &context) {
  if (condition) return true;
  ++failures;
  std::cout << file << ":" << line << ": " << text << (context.empty() ? "" : " (" + context + ")") << "\n";
  return false;
}
#define CHECK(condition) check((condition), #condition, __FILE__, __LINE__, "")
#define CHECK_IN(condition, context) check((condition), #condition, __FILE__, __LINE__, context)

inline std::string file_text(const std::string &path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Random numbers with a fixed seed.
class Random {
public:
  double between(double lower, double upper) { return std::uniform_real_distribution<double>(lower, upper)(engine_); }

private:
  std::mt19937_64 engine_{7};
};
