# Read after project() in a build for mutation testing: -DCMAKE_PROJECT_INCLUDE.  EDML_HARNESS: harness.c, compiled.
add_compile_options(-O2 -w -include ${CMAKE_CURRENT_LIST_DIR}/harness.h)
add_link_options(LINKER:--wrap=UnityDefaultTestRun ${EDML_HARNESS})
