# Read after project() in a build for mutation testing: -DCMAKE_PROJECT_INCLUDE.  EDML_HARNESS: harness.c, compiled.
# The sanitizers see what a mutant does out of bounds or out of range.
add_compile_options(-O1 -w -include ${CMAKE_CURRENT_LIST_DIR}/harness.h -fsanitize=address,undefined -fno-sanitize-recover=all)
add_link_options(LINKER:--wrap=UnityDefaultTestRun ${EDML_HARNESS} -fsanitize=address,undefined)
