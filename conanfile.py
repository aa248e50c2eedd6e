"""The recipe for Conan 2: `conan create .` (docs/packages.md)."""

import re
from pathlib import Path

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout
from conan.tools.files import copy, rmdir


class EdmliftConan(ConanFile):
    name = "edmlift"
    description = "14 detected 2D joints in, a 3D pose in metres out, on a microcontroller"
    license = "MIT"
    topics = ("pose-estimation", "computer-vision", "keypoints", "embedded")
    package_type = "library"
    settings = "os", "compiler", "build_type", "arch"
    options = {"shared": [True, False], "fPIC": [True, False], "models": ["ANY"]}
    default_options = {"shared": False, "fPIC": True, "models": ""}
    options_description = {
        "models": 'models to compile, such as "distances_w16;direct_w16"; empty: all',
    }
    languages = "C"
    implements = ["auto_shared_fpic"]
    exports_sources = (
        "CMakeLists.txt", "LICENSE", "cmake/*", "gen/*.h", "include/*", "lib/*",
    )  # fmt: skip
    test_package_folder = "tests/channels/conan"

    def set_version(self) -> None:
        """The version is written in the header."""
        header = Path(self.recipe_folder, "include", "edmlift.h").read_text("utf-8")
        self.version = re.search(r'EDML_VERSION_STRING "(.+?)"', header)[1]

    def layout(self) -> None:
        cmake_layout(self)

    def generate(self) -> None:
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["EDMLIFT_EXAMPLES"] = False
        toolchain.cache_variables["EDMLIFT_MODELS"] = str(self.options.models)
        toolchain.generate()

    def build(self) -> None:
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self) -> None:
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, Path(self.package_folder, "licenses"))
        for folder in ("cmake", "pkgconfig"):  # Conan writes these for its users
            rmdir(self, Path(self.package_folder, "lib", folder))

    def package_info(self) -> None:
        self.cpp_info.libs = ["edmlift"]
        if self.settings.os != "Windows":
            self.cpp_info.system_libs = ["m"]
