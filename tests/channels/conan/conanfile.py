"""A consumer of the Conan package: the project of tests/install, in C and in C++."""

from pathlib import Path

from conan import ConanFile
from conan.tools.build import can_run
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout


class EdmliftTestConan(ConanFile):
    settings = "os", "compiler", "build_type", "arch"
    generators = "CMakeDeps"

    def requirements(self) -> None:
        self.requires(self.tested_reference_str)

    def layout(self) -> None:
        cmake_layout(self)

    def generate(self) -> None:
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["WAY"] = "package"
        toolchain.generate()

    def build(self) -> None:
        cmake = CMake(self)
        cmake.configure(build_script_folder="../../install")
        cmake.build()

    def test(self) -> None:
        if can_run(self):
            for program in ("consumer_c", "consumer_cpp"):
                folder = Path(self.build_folder, self.cpp.build.bindir)
                self.run(str(folder / program), env="conanrun")
