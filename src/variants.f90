!> The variants of a set with VARY cards, one after another: each is made when its turn comes, starts from the deck's
!> own estimate and leaves a row. So the row is the same whatever the others are, and memory does not grow with them.
!> A variant that cannot be computed is a row that says so.
module variants
   use mechanism, only: mechanism_t
   use independent, only: parts_t
   use structure, only: findings_t, check_structure
   use failures, only: failure_t, status_flagged
   use deck, only: build_variant
   use deck_variants, only: variation_t
   use progress, only: show_progress
   use listing, only: layout_t, new_layout
   use solver_log, only: log_head
   use answers, only: answers_t
   use variant_rows, only: summary_t, variant_row_t, new_summary, new_row, fill_row
   use variant_tables, only: summary_head, summary_row, put_variant, put_variant_heads, put_variant_row, &
      put_variants_end, put_broken_off
   use numerals, only: whole
   use command_line, only: options_t, out_listing, out_log, out_summary
   use outputs, only: is_over
   use instants, only: writers_t, run_motion
   implicit none
   private
   public :: run_variants

contains

   !> Solves and writes the variants `first` to `last` of `v`, those of set number `i`, `m`, whose independent
   !> mechanisms are `parts`.
   subroutine run_variants(options, m, i, first, last, parts, v, o, status)
      type(options_t), intent(in) :: options
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i, first, last
      type(parts_t), intent(in) :: parts
      type(variation_t), intent(inout) :: v
      type(writers_t), intent(inout) :: o
      integer, intent(inout) :: status
      type(layout_t) :: layout
      type(summary_t) :: summary
      type(variant_row_t) :: row
      type(mechanism_t) :: variant(1)
      logical :: full
      integer :: n

      full = any(m%requests%every > 0)
      layout = new_layout(m)
      summary = new_summary(m, parts, layout, v)
      if (o%asked(out_summary) .and. first == 1) call summary_head(o%files(out_summary, 0), summary)
      if (o%asked(out_listing) .and. first == 1 .and. .not. full) &
         call put_variant_heads(o%files(out_listing, 0), summary)
      do n = first, last
         row = new_row(summary, v, n)
         if (o%asked(out_listing) .and. full) &
            call put_variant(o%files(out_listing, 0), layout, summary, m, row)
         call run_variant(options, i, full, v, summary, variant, row, o)
         if (is_over(o, i)) exit
         if (o%asked(out_summary)) call summary_row(o%files(out_summary, 0), summary, m, row)
         if (o%asked(out_listing)) then
            if (full) call put_variant_heads(o%files(out_listing, 0), summary)
            call put_variant_row(o%files(out_listing, 0), layout, summary, m, row)
         end if
         if (row%flagged > 0 .or. row%rejected /= '') status = status_flagged
         if (o%progress%shown) call show_progress(o%progress, 'SET '//whole(i)//': VARIANT', n, v%total)
      end do
      if (.not. o%asked(out_listing)) return
      if (n <= last) call put_broken_off(o%files(out_listing, 0), m, n - 1)
      if (n > v%total) call put_variants_end(o%files(out_listing, 0), m)
   end subroutine run_variants

   !> Solves and writes the variant of `v` whose `row` this is, of set number `i`: it is variant(1) now. `full`: its
   !> tables are asked for.
   subroutine run_variant(options, i, full, v, summary, variant, row, o)
      type(options_t), intent(in) :: options
      integer, intent(in) :: i
      logical, intent(in) :: full
      type(variation_t), intent(inout) :: v
      type(summary_t), intent(in) :: summary
      type(mechanism_t), intent(out) :: variant(1)
      type(variant_row_t), intent(inout) :: row
      type(writers_t), intent(inout) :: o
      type(findings_t), allocatable :: findings(:)
      type(failure_t), allocatable :: failure
      type(answers_t) :: asked

      call build_variant(v, row%number, variant(1), row%rejected)
      if (row%rejected == '') then
         call check_structure(variant, findings, failure)
         if (allocated(failure)) row%rejected = failure%text(:index(failure%text//new_line('a'), new_line('a')) - 1)
      end if
      if (row%rejected == '') then
         if (full .and. o%asked(out_listing)) o%layout = new_layout(variant(1))
         if (o%asked(out_log)) call log_head(o%files(out_log, 0), variant(1), options%errors)
         call run_motion(options, variant(1), i, findings(1), full, o, row, asked)
      end if
      call fill_row(summary, variant(1), asked, row)
   end subroutine run_variant
end module variants
