"""Files of supports, ``workhold-supports/1``: a planar fixture, what was asked, and the triples."""
