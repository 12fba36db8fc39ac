# Run at build time: says in OUTPUT which commit the sources are at, "dirty" when they were changed since.
# Variables: SOURCE, TEMPLATE, OUTPUT, and what the template names.
find_package(Git QUIET)
set(ARGIL_COMMIT "unknown")
if(GIT_FOUND)
  execute_process(COMMAND "${GIT_EXECUTABLE}" describe --always --dirty --abbrev=12
                  WORKING_DIRECTORY "${SOURCE}" OUTPUT_VARIABLE described
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(ARGIL_COMMIT "${described}")
  endif()
endif()
configure_file("${TEMPLATE}" "${OUTPUT}" @ONLY)
# Newer than what it was made of, also when nothing in it changed: ninja has no more to do then.
file(TOUCH_NOCREATE "${OUTPUT}")
