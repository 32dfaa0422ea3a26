#!/bin/sh
# Compiles the importers in C into a folder: build.sh FOLDER
# It needs git, cmake and cc; on Debian and Ubuntu: apt-get install git cmake gcc libxml2-dev zlib1g-dev \
# libminizip-dev libsundials-dev
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
cd "$1"

cc -O1 -std=c11 -Wall -Wextra -o c_host -I "$here/../../../fmus/native/c" "$here/c_host.c" -ldl

# fmusim, as it stood last in the repository of the Reference FMUs
git clone -q --no-checkout https://github.com/modelica/Reference-FMUs reference-fmus
mkdir reference
git -C reference-fmus archive c8d4e6d fmusim include src | tar x -C reference
(
    cd reference/fmusim
    cc -O1 -w -o ../../fmusim -I . -I ../include -I /usr/include/libxml2 -I /usr/include/minizip \
        -DFMUSIM_VERSION='"c8d4e6d"' -DSUN_COMM_NULL=NULL \
        ../src/FMI.c ../src/FMI[123].c ../src/structured_variable_name.yy.c ../src/structured_variable_name.tab.c \
        csv.c FMIUtil.c FMIEuler.c FMICVode.c FMIModelDescription.c FMIRecorder.c FMIZip.c FMISimulation.c \
        FMIStaticInput.c FMI[123]CSSimulation.c FMI[123]MESimulation.c fmusim.c miniunzip.c \
        -lxml2 -lminizip -lz -lsundials_cvode -lsundials_generic -ldl -lm
)

# fmuCheck, the FMU Compliance Checker, with the FMI Library
git clone -q --no-checkout https://github.com/modelon-community/fmi-library fmi-library
mkdir fmil library
git -C fmi-library archive 2.4.1 | tar x -C fmil
(
    cd library
    cmake ../fmil -DFMILIB_INSTALL_PREFIX="$PWD" -DCMAKE_INSTALL_PREFIX="$PWD" \
        -DFMILIB_BUILD_TESTS=OFF -DFMILIB_GENERATE_DOXYGEN_DOC=OFF >cmake.log 2>&1
    make install >make.log 2>&1
)
git clone -q https://github.com/modelica-tools/FMUComplianceChecker checker
: >library/fmu_checker_version.h
cc -O1 -w -o fmuCheck -I checker/include -I library/include -I library \
    -DFMUCHK_VERSION='"c704b98"' -DFMIL_VERSION='"2.4.1"' checker/src/*/*.c library/lib/libfmilib.a -ldl -lm -lpthread
ls -l c_host fmusim fmuCheck
