# SPDX-License-Identifier: MIT
"""Builds the package's consumers: the toy programs of tests/package, one a component."""
from pathlib import Path

from conan import ConanFile
from conan.tools.build import can_run
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout


class TestPackage(ConanFile):
    settings = "os", "arch", "compiler", "build_type"
    generators = "CMakeDeps", "VirtualRunEnv"

    def requirements(self):
        self.requires(self.tested_reference_str)

    def _components(self):
        options = self.dependencies["genrender"].options
        optional = [name for name in ("scene", "reference") if options.get_safe(name)]
        return ["core", "inspection", "evaluation", "c"] + optional

    def layout(self):
        cmake_layout(self)

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["COMPONENTS"] = ";".join(self._components())
        toolchain.generate()

    def build(self):
        toy = Path(self.recipe_folder) / "../../../tests/package/toy"
        cmake = CMake(self)
        cmake.configure(build_script_folder=toy.resolve())
        cmake.build()

    def test(self):
        if can_run(self):
            for component in self._components():
                program = Path(self.build_folder) / self.cpp.build.bindir / f"toy_{component}"
                self.run(f'"{program}"', env="conanrun")
