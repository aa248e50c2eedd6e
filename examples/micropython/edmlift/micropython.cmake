# For ports that are built by CMake: USER_C_MODULES is this file.
get_filename_component(edmlift ${CMAKE_CURRENT_LIST_DIR}/../../.. ABSOLUTE)
file(GLOB edmlift_sources ${edmlift}/lib/joints/*.c ${edmlift}/lib/lift/*.c ${edmlift}/lib/network/*.c
     ${edmlift}/lib/number/*.c)
add_library(usermod_edmlift INTERFACE)
target_sources(usermod_edmlift INTERFACE ${CMAKE_CURRENT_LIST_DIR}/modedmlift.c ${edmlift_sources}
               ${edmlift}/lib/models/direct_w16.c)
target_include_directories(usermod_edmlift INTERFACE ${edmlift}/include)
target_link_libraries(usermod INTERFACE usermod_edmlift)
