"""The rules that hold a fixture to its toolkit, one module for each kind of contact or freedom.

``hardware`` puts them together from the data of a toolkit's carriers: which of them stand still or slide
along a line, and which contact they make. No rule asks which kind of toolkit it is.
"""
