# Unity, the C test framework (ThrowTheSwitch): target `unity`, for the tests alone.
#
# In this order:
#   -DUNITY_ROOT=FOLDER           with unity.c and unity.h, or with src/ that has them
#   an installed package          that has a CMake configuration, target unity::framework
#   -DEDMLIFT_FETCH_UNITY=ON      a pinned release of Unity's own repository
#   tests/get_unity.sh            the copy in Debian's source package of cjson
set(UNITY_ROOT "" CACHE PATH "Folder with Unity's unity.c and unity.h")
option(EDMLIFT_FETCH_UNITY "Fetch a release of Unity by git" OFF)

function(edmlift_unity_from folder)
  find_path(unity_folder unity.c PATHS ${folder}/src ${folder} NO_DEFAULT_PATH NO_CACHE)
  if(unity_folder)
    add_library(unity STATIC ${unity_folder}/unity.c)
    target_include_directories(unity SYSTEM PUBLIC ${unity_folder})
    set(Unity_FOUND TRUE PARENT_SCOPE)
  endif()
endfunction()

set(Unity_FOUND FALSE)
if(UNITY_ROOT)
  edmlift_unity_from(${UNITY_ROOT})
  if(NOT Unity_FOUND)
    message(FATAL_ERROR "UNITY_ROOT: no unity.c in ${UNITY_ROOT} or its src/")
  endif()
endif()

if(NOT Unity_FOUND)
  find_package(unity CONFIG QUIET)
  if(TARGET unity::framework)
    add_library(unity INTERFACE)
    target_link_libraries(unity INTERFACE unity::framework)
    set(Unity_FOUND TRUE)
  endif()
endif()

if(NOT Unity_FOUND AND EDMLIFT_FETCH_UNITY)
  include(FetchContent)
  FetchContent_Declare(unity_source
    GIT_REPOSITORY https://github.com/ThrowTheSwitch/Unity.git GIT_TAG v2.5.2 GIT_SHALLOW ON)
  FetchContent_GetProperties(unity_source)
  if(NOT unity_source_POPULATED)
    FetchContent_Populate(unity_source) # its sources alone, not its build
  endif()
  edmlift_unity_from(${unity_source_SOURCE_DIR})
endif()

if(NOT Unity_FOUND)
  set(unity_copy ${CMAKE_BINARY_DIR}/unity)
  execute_process(COMMAND ${CMAKE_CURRENT_LIST_DIR}/../tests/get_unity.sh ${unity_copy}
                  TIMEOUT 120 OUTPUT_VARIABLE unity_said ERROR_VARIABLE unity_said)
  edmlift_unity_from(${unity_copy})
endif()

if(NOT Unity_FOUND)
  message(FATAL_ERROR "The tests need Unity, which was not found:\n${unity_said}\n"
    "Give its folder, -DUNITY_ROOT=FOLDER (with unity.c and unity.h), or allow a download from its "
    "repository, -DEDMLIFT_FETCH_UNITY=ON, or do without the tests, -DEDMLIFT_TESTS=OFF.")
endif()
