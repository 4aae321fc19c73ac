"""Better tetrahedra: flips, moves of vertices, vertices put in and taken out."""
