#include "device/lent_pages.hpp"

#include <utility>

namespace dapple {

void hand_over(std::unique_ptr<Pages> pages, cl::Buffer& buffer,
               const std::shared_ptr<PagePool>& pool) {
  struct Loan {
    std::unique_ptr<Pages> pages;
    std::shared_ptr<PagePool> pool;
  };
  auto loan = std::make_unique<Loan>(Loan{std::move(pages), pool});
  const auto end_loan = [](cl_mem, void* data) noexcept {
    const std::unique_ptr<Loan> ended(static_cast<Loan*>(data));
    ended->pool->give_back(std::move(ended->pages));
  };
  buffer.setDestructorCallback(end_loan, loan.get());
  (void)loan.release();
}

}  // namespace dapple
