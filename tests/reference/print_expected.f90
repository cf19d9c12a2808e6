!> Tests. `print_expected DECK` prints, from the closed form in real128, the listing that `kinmat DECK` must print.
!> The deck is read, and what stands before and behind the tables is printed, by the program's own modules; the digits,
!> powers of ten, rows and masks are computed in real128 by modules of tests/. No solver is used.
program print_expected
   use, intrinsic :: iso_fortran_env, only: error_unit
   use kinds, only: wp
   use failures, only: failure_t
   use mechanism, only: mechanism_t, request_t, instant_count, instant, drive_angle, request_pair
   use motion, only: diagnostic_t, diagnostic_stroke
   use structure, only: structure_report_t
   use continuation, only: certificate_counts_t
   use expected_groups, only: count_by_hand, groups_by_hand, redundant_by_hand, passages_by_hand
   use deck, only: read_deck, build_variant
   use deck_variants, only: variation_t
   use independent, only: set_t, divide
   use listing_layout, only: layout_t
   use answers, only: answers_t
   use variant_rows, only: summary_t, variant_row_t, new_summary, new_row, fill_row
   use variant_tables, only: write_variant, write_variant_heads, write_variant_row, write_variants_end
   use text_output, only: output_t, open_output, close_output, put
   use listing, only: new_layout, listing_head, listing_end, write_diagnostics
   use quad_jet, only: qp
   use expected_scales, only: listed_t, listed_set
   use expected_rows, only: expected_row_t, row_by_hand
   use expected_estimates, only: estimates_by_hand
   use expected_tables, only: above_t, put_tables
   use closed_forms_dyads, only: body_t
   use test_counter, only: deck_name
   use closed_forms, only: closed_form
   use expected_links, only: move_links_to
   use expected_columns, only: put_columns_by_hand
   use expected_tolerances, only: put_shares_by_hand
   use expected_extremes, only: put_extremes_by_hand
   use expected_assemblies, only: put_assemblies_by_hand, put_circuits_by_hand
   implicit none
   character(500) :: path
   character(:), allocatable :: name, report
   type(mechanism_t), allocatable :: sets(:)
   type(variation_t), allocatable :: variations(:)
   type(failure_t), allocatable :: failure
   type(output_t) :: o
   integer :: i

   call get_command_argument(1, path)
   name = deck_name(trim(path))
   if (size(closed_form(name, 1, 0.0_qp)) == 0) call give_up('NO CLOSED FORM FOR THE DECK '//trim(path))
   call read_deck(trim(path), sets, report, failure, variations=variations)
   if (allocated(failure)) call give_up(failure%text//new_line('a')//report)
   call open_output(o, '', failure)
   do i = 1, size(sets)
      call print_head(o, name, sets(i))
      if (sets(i)%variants == 0) then
         call print_motion(o, name, sets(i))
      else
         call print_variants(o, name, sets(i), variations(i))
      end if
   end do
   call close_output(o, failure)
   if (allocated(failure)) call give_up(failure%text)

contains

   !> The deck and the structure of one set.
   subroutine print_head(o, name, m)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      type(structure_report_t) :: structure_report

      structure_report = count_by_hand(name)
      structure_report%groups = groups_by_hand(name, m)
      call listing_head(o, m, structure_report)
   end subroutine print_head

   !> The variants `v` of the set `m`: of each its tables and its row. No question but PRINT is asked.
   subroutine print_variants(o, name, m, v)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      type(variation_t), intent(inout) :: v
      type(layout_t) :: layout
      type(summary_t) :: summary
      type(variant_row_t) :: row
      type(mechanism_t) :: variant
      type(set_t) :: set
      type(answers_t) :: nothing
      integer :: n

      call divide(m, set)
      layout = new_layout(set)
      summary = new_summary(set, layout, v)
      do n = 1, m%variants
         call build_variant(v, n, variant, report)
         if (report /= '') call give_up(report)
         row = new_row(summary, v, n)
         call write_variant(o, layout, summary, m, row)
         call print_motion(o, name, variant)
         row%solved = instant_count(variant)
         call divide(variant, set)
         call fill_row(summary, set, nothing, row)
         call write_variant_heads(o, summary)
         call write_variant_row(o, layout, summary, set, row)
      end do
      call write_variants_end(o, m)
   end subroutine print_variants

   !> The motion of one set or variant.
   subroutine print_motion(o, name, m)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      type(listed_t) :: listed
      type(set_t) :: set
      type(above_t) :: above
      type(certificate_counts_t) :: tally
      type(diagnostic_t), allocatable :: diagnostics(:)
      type(body_t) :: links(size(m%links))
      real(qp), allocatable :: error(:, :, :)
      logical :: resting(size(m%links)), was_flagged(0:max(0, instant_count(m) - 1))
      character(:), allocatable :: fault
      type(set_t) :: whole
      integer, allocatable :: crossing(:)
      integer :: k, at

      ! Not divided: links are counted as in the deck.
      whole%settings_t = m%settings_t
      whole%parts = [m]
      listed = listed_set(name, m)
      links%phi%v = real(m%links%position(3), qp)
      was_flagged = .false.
      do k = 0, instant_count(m) - 1
         call move_links_to(name, m, real(instant(m, k), qp), links, fault)
         if (fault /= '') call give_up(fault)
         resting = .false.
         crossing = [integer ::]
         if (k == 0) diagnostics = redundant_by_hand(name, m)
         if (k > 0) then
            diagnostics = passages_by_hand(name, m, instant(m, k - 1), instant(m, k))
            tally%passed = tally%passed + count(.not. diagnostics%here)
            if (any(diagnostics%here)) then
               resting = not_driven(m)
               was_flagged(k) = .true.
               at = findloc(diagnostics%here, .true., dim=1)
               crossing = pack(diagnostics(at)%links, diagnostics(at)%links > 0)
            end if
         end if
         ! Next to dead points only are digits in doubt.
         error = reshape([real(qp) ::], [3, 3, 0])
         if (index(name, 'dead_point') == 1) error = estimates_by_hand(m, real(instant(m, k), qp))
         diagnostics = [diagnostics, out_of_strokes(m, links)]
         call put_tables(o, listed, k, links, resting, crossing, error, size(diagnostics) > 0, above)
         if (any(diagnostics%kind == diagnostic_stroke)) then
            was_flagged(k) = .true.
            call put(o, ' *** OUT OF STROKE')
         end if
         call write_diagnostics(o, whole, diagnostics)
      end do
      ! All of these motions are followed from their first instant on.
      tally%followed = instant_count(m) - 1
      call put_columns_by_hand(o, listed)
      if (any(m%requests%extremes)) call put_extremes_by_hand(o, listed, was_flagged)
      if (m%assemblies) call put_assemblies_by_hand(o, listed)
      if (m%circuits) call put_circuits_by_hand(o)
      if (allocated(m%tolerances)) call put_shares_by_hand(o, listed)
      call divide(m, set)
      call listing_end(o, set, count(.not. was_flagged), count(was_flagged), tally, &
         merge(0.0_wp, -1.0_wp, size(redundant_by_hand(name, m)) > 0), 0.0_wp, [diagnostic_t ::])
   end subroutine print_motion

   !> The cylinders of `m` whose length is out of their stroke, its links being at `links`.
   function out_of_strokes(m, links) result(list)
      type(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: links(:)
      type(diagnostic_t), allocatable :: list(:)
      type(expected_row_t) :: row
      integer :: i

      allocate (list(0))
      do i = 1, size(m%pairs)
         if (m%pairs(i)%stroke(1) <= 0.0_wp) cycle
         row = row_by_hand(m, links, request_t(kind=request_pair, subject=i))
         if (row%value(1, 0) < m%pairs(i)%stroke(1) .or. row%value(1, 0) > m%pairs(i)%stroke(2)) list = [list, &
            diagnostic_t(kind=diagnostic_stroke, pair=i, value=real(row%value(1, 0), wp))]
      end do
   end function out_of_strokes

   !> (links) At a change point two branches have the same position, and each has velocities of its own: there are none
   !> but those of the ground and of links whose angle is driven.
   function not_driven(m) result(resting)
      type(mechanism_t), intent(in) :: m
      logical :: resting(size(m%links))
      integer :: i

      resting = .not. m%links%ground
      do i = 1, size(m%drives)
         if (m%drives(i)%kind == drive_angle) resting(m%drives(i)%subject) = .false.
      end do
   end function not_driven

   !> Ends the program with a sentence and the status 1.
   subroutine give_up(text)
      character(*), intent(in) :: text

      write (error_unit, '(a)') ' *** '//text
      error stop 1, quiet=.true.
   end subroutine give_up
end program print_expected
