"""Problems with known answers, solved by the kernels and the step that forming runs use."""
