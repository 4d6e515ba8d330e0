from glob import glob

from setuptools import setup

setup(
    name="@NAME@",
    version="0.1.0",
    packages=["@NAME@"],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/@NAME@"]),
        ("share/@NAME@", ["package.xml"]),
        ("share/@NAME@/launch", glob("launch/*.launch.py")),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    entry_points={"console_scripts": ["helm = @NAME@.helm:main"]},
)
