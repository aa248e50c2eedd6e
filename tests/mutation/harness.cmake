# Read after project() in a build for mutation testing: -DCMAKE_PROJECT_INCLUDE.
#   EDML_HARNESS   harness.c, compiled
#   EDML_FLAGS     of compiler and linker
add_compile_options(-w -include ${CMAKE_CURRENT_LIST_DIR}/harness.h ${EDML_FLAGS})
add_link_options(LINKER:--wrap=UnityDefaultTestRun ${EDML_HARNESS} ${EDML_FLAGS})
