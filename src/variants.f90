!> The variants of a set with VARY cards: each is made when its turn comes, starts from the deck's own estimate and
!> leaves a row. So the row is the same whatever the others are, and memory does not grow with them. Where rows alone
!> are asked for, some are solved together. A variant that cannot be computed is a row that says so.
module variants
   use mechanism, only: mechanism_t
   use independent, only: parts_t
   use structure, only: findings_t, find_structure_again, faults_text
   use failures, only: status_flagged
   use deck, only: build_variant
   use deck_variants, only: variation_t
   use progress, only: show_progress
   use listing, only: layout_t, new_layout
   use solver_log, only: log_head
   use answers, only: answers_t
   use variant_rows, only: summary_t, variant_row_t, new_summary, new_row, fill_row
   use variant_tables, only: summary_head, summary_row, put_variant, put_variant_heads, put_note_of_shares, &
      put_variant_row, put_variants_end, put_broken_off
   use numerals, only: whole
   use lane_runs, only: lane_run_t, begin_run, run_lanes, width
   use lane_state, only: lanes_t
   use command_line, only: options_t, out_listing, out_csv, out_log, out_summary
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
      logical :: full
      integer :: n

      n = first
      full = any(m%requests%every > 0)
      layout = new_layout(m)
      summary = new_summary(m, parts, layout, v)
      if (o%asked(out_summary) .and. first == 1) call summary_head(o%files(out_summary, 0), summary)
      if (o%asked(out_listing) .and. first == 1 .and. .not. full) then
         call put_note_of_shares(o%files(out_listing, 0), m)
         call put_variant_heads(o%files(out_listing, 0), summary)
      end if
      if (full .or. m%proves .or. o%asked(out_csv) .or. o%asked(out_log)) then
         call run_each()
      else
         call run_together()
      end if
      if (.not. o%asked(out_listing)) return
      if (n <= last) call put_broken_off(o%files(out_listing, 0), m, n - 1)
      if (n > v%total) call put_variants_end(o%files(out_listing, 0), m)

   contains

      !> Solves and writes the variants `n` to `last` of `v` one after another; `n`: the first that is not written.
      subroutine run_each()
         type(variant_row_t) :: row
         type(mechanism_t) :: variant
         type(findings_t) :: findings

         do while (n <= last)
            row = new_row(summary, v, n)
            if (o%asked(out_listing) .and. full) &
               call put_variant(o%files(out_listing, 0), layout, summary, m, row)
            call run_variant(variant, findings, row)
            if (is_over(o, i)) return
            if (o%asked(out_listing) .and. full) call put_variant_heads(o%files(out_listing, 0), summary)
            call write_row(row)
            n = n + 1
         end do
      end subroutine run_each

      !> The same of rows alone, as many variants at a time as there are lanes.
      subroutine run_together()
         type(lane_run_t), allocatable :: runs(:)
         type(lanes_t) :: lanes
         type(findings_t) :: findings
         integer :: k, count

         allocate (runs(width))
         do while (n <= last)
            count = min(width, last - n + 1)
            do k = 1, count
               runs(k)%row = new_row(summary, v, n + k - 1)
               call start(findings, runs(k))
            end do
            call run_lanes(runs(:count), lanes)
            do k = 1, count
               if (is_over(o, i)) return
               call fill_row(summary, runs(k)%m, runs(k)%asked, runs(k)%row)
               call write_row(runs(k)%row)
               n = n + 1
            end do
         end do
      end subroutine run_together

      !> Makes the variant of `v` whose row `r` has, unless it is refused; `findings`: as below.
      subroutine start(findings, r)
         type(findings_t), intent(inout) :: findings
         type(lane_run_t), intent(inout) :: r

         call make_variant(r%row, r%m, findings)
         r%is_over = r%row%rejected /= ''
         if (.not. r%is_over) call begin_run(r, findings)
      end subroutine start

      !> Makes the variant of `v` whose `row` this is, and finds its structure, starting from the `findings` of the one
      !> before; what the checks say stands in the row.
      subroutine make_variant(row, variant, findings)
         type(variant_row_t), intent(inout) :: row
         type(mechanism_t), intent(out) :: variant
         type(findings_t), intent(inout) :: findings
         character(:), allocatable :: faults

         call build_variant(v, row%number, variant, row%rejected)
         if (row%rejected /= '') return
         call find_structure_again(variant, findings)
         faults = faults_text(variant, findings, variant%set_number)
         row%rejected = faults(:index(faults//new_line('a'), new_line('a')) - 1)
      end subroutine make_variant

      !> Solves and writes the variant of `v` whose `row` this is, of set number `i`: it is `variant` now. `full`: its
      !> tables are asked for. `findings`: as above.
      subroutine run_variant(variant, findings, row)
         type(mechanism_t), intent(out) :: variant
         type(findings_t), intent(inout) :: findings
         type(variant_row_t), intent(inout) :: row
         type(answers_t) :: asked

         call make_variant(row, variant, findings)
         if (row%rejected == '') then
            if (full .and. o%asked(out_listing)) o%layout = new_layout(variant)
            if (o%asked(out_log)) call log_head(o%files(out_log, 0), variant, options%errors)
            call run_motion(options, variant, i, findings, full, o, row, asked)
         end if
         call fill_row(summary, variant, asked, row)
      end subroutine run_variant

      !> Writes the `row` of a variant.
      subroutine write_row(row)
         type(variant_row_t), intent(in) :: row

         if (o%asked(out_summary)) call summary_row(o%files(out_summary, 0), summary, m, row)
         if (o%asked(out_listing)) call put_variant_row(o%files(out_listing, 0), layout, summary, m, row)
         if (row%flagged + row%unproved > 0 .or. row%rejected /= '') status = status_flagged
         if (o%progress%shown) call show_progress(o%progress, 'SET '//whole(i)//': VARIANT', row%number, v%total)
      end subroutine write_row
   end subroutine run_variants
end module variants
