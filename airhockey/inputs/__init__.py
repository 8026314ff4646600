"""What comes from outside: files that people wrote, names that strangers chose, contents that must stay the same.

plain_yaml.py   the only reader of YAML
names.py        how a stranger's text is shown
hashing.py      files, folders and archives, known by their content
packages.py     what is installed beside us
temporary_folders.py    where archives are unpacked: gone with the process
"""
