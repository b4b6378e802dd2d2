"""What is odd about a model: findings, by the rules that explain them."""
