"""Robot files: a robot of the catalogue with sizes, limits and a name of one's own, in YAML."""

from krhpr.robot_files.problems import Problem, RobotFileError, RobotFileWarning
from krhpr.robot_files.reader import RobotFile, is_robot_file, read_robot_file

__all__ = [
    "Problem",
    "RobotFile",
    "RobotFileError",
    "RobotFileWarning",
    "is_robot_file",
    "read_robot_file",
]
