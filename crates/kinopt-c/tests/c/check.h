/* Failures of a test program. */
#ifndef CHECK_H
#define CHECK_H

#include <stdio.h>

static int failures = 0;

#define CHECK(condition)                                                                           \
  do {                                                                                             \
    if (!(condition)) {                                                                            \
      ++failures;                                                                                  \
      printf("%s:%d: %s; last error: %s\n", __FILE__, __LINE__, #condition,                        \
             kinopt_error_message());                                                              \
    }                                                                                              \
  } while (0)

#define OK(call) CHECK((call) == KINOPT_STATUS_OK)

#endif
