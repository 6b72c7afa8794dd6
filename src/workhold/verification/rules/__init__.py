"""The rules that hold a fixture to its toolkit, one module for each kind of contact or freedom.

``hardware`` puts them together as the carriers of a toolkit say: what stands still, what slides along which
line, what is bolted in a hole of what, and which is a wall. No rule asks which kind of toolkit it is.
"""
