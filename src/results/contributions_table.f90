!> The shares of tolerances in the listing: for each quantity the share of each number in the sum of squares, the
!> largest first.
module contributions_table
   use kinds, only: wp
   use mechanism, only: request_t, tolerance_t
   use independent, only: set_t
   use set_members, only: requests_of, row_form, row_subject, tolerances_of
   use columns, only: row_column_t, columns_of_rows, forms, kinds_of_rows, row_turning
   use table, only: format_t, unit_of, number_text
   use tolerance_contributions, only: contributions_t, contribution_t, equal_share_part
   use listing_layout, only: layout_t, column_name, column_unit, column_format
   use listing_tables, only: time_text
   use text_output, only: output_t, put
   use number_format, only: fixed, whole
   use phrases
   implicit none
   private
   public :: write_shares

   !> Smaller shares are only counted.
   real(wp), parameter :: least_share = 1.0e-4_wp
   !> Decimals of a share in per cent.
   integer, parameter :: percent_decimals = 2
   !> A share is enlarged by this part, so that a half that rounding has left below a half is rounded up.
   real(wp), parameter :: half_up = max(1.0e-9_wp, 8.0_wp*epsilon(1.0_wp))
   !> Characters of the name of a number before its sensitivity, unless it is longer.
   integer, parameter :: parameter_name = 36

contains

   !> Writes the shares of tolerances after the last instant of a set.
   subroutine write_shares(o, l, shares, set)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(contributions_t), intent(in) :: shares   !< after the last instant
      class(set_t), intent(in) :: set        !< of the shares
      type(request_t), allocatable :: requests(:)
      type(tolerance_t), allocatable :: tolerances(:)
      integer :: i, c, d, j, form

      call put(o, '')
      call put(o, ' '//phrase(text_shares, set%polish))
      requests = requests_of(set)
      if (any(kinds_of_rows(requests%kind)%is_centre)) &
         call put(o, ' --- '//phrase(text_no_shares, set%polish))
      if (any(requests%drive > 0)) &
         call put(o, ' --- '//phrase(text_no_ratio_shares, set%polish))
      do c = 1, set%count
         tolerances = tolerances_of(set, c)
         do d = 1, size(tolerances)
            if (shares%jams(d, c)) &
               call put(o, ' *** '//trim(tolerances(d)%name)//': '//phrase(text_jams, set%polish))
         end do
      end do

      do i = 1, size(set%rows)
         form = merge(row_turning, row_form(set, i), requests(i)%angle_alone)
         do j = forms(form)%first, forms(form)%last
            associate (column => columns_of_rows(j))
               call write_quantity(o, l, set, i, column, shares%list(column%at(1), column%at(2), i))
            end associate
         end do
      end do
   end subroutine write_shares

   !> Writes the lines of a quantity, one column of a row; none if the quantity has no sensitivities, or if its root of
   !> squares is zero in the tables.
   subroutine write_quantity(o, l, set, row, column, share)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      class(set_t), intent(in) :: set        !< of the shares
      integer, intent(in) :: row             !< number of the row in the set
      type(row_column_t), intent(in) :: column   !< of the quantity
      type(contribution_t), intent(in) :: share   !< of the quantity
      character(:), allocatable :: unit, word
      type(format_t) :: f
      integer :: i
      real(wp), allocatable :: part(:)
      character(12) :: sensitivity
      type(tolerance_t), allocatable :: tolerances(:)

      if (.not. allocated(share%s)) return
      f = column_format(l, set, row, column)
      f%decimals = f%decimals + l%more_decimals
      if (share%root/f%unit < 0.5_wp*10.0_wp**(f%power - f%decimals)) return
      unit = unit_of(f%power, column_unit(l, column))
      associate (kind => kinds_of_rows(forms(row_form(set, row))%kind))
         word = trim(merge(kind%polish, kind%english, l%polish))
      end associate
      call put(o, ' '//word//' '//trim(row_subject(set, row))//'  ' &
         //column_name(l, column)//'   T = '//time_text(l, share%t)//l%after_time &
         //'   RSS = '//number_text(f, share%root, 0.0_wp)//'   '//phrase(text_worst, l%polish)//' = ' &
         //number_text(f, share%worst, 0.0_wp)//' '//unit)

      ! A line for each number with a larger share than the least, the largest first: share, name, sensitivity,
      ! tolerance.
      tolerances = tolerances_of(set, set%rows(row)%part)
      part = (share%s*tolerances%size_of/share%root)**2
      do while (any(part >= least_share))
         ! If some are equal, the first one comes first.
         i = findloc(part >= maxval(part)*(1.0_wp - equal_share_part), .true., dim=1)
         associate (one => tolerances(i))
            write (sensitivity, '(es12.4e3)') share%s(i)/f%unit
            ! A half is rounded up, whatever the last bit.
            call put(o, fixed(100.0_wp*part(i)*(1.0_wp + half_up), percent_decimals, 0)//' %  ' &
               //one%name(:max(parameter_name, len_trim(one%name)))//'  S = '//sensitivity//'   +- ' &
               //trim(one%text)//' '//trim(one%unit_name))
         end associate
         part(i) = -1.0_wp
      end do
      if (any(part >= 0.0_wp)) call put(o, '   '//phrase(text_small_shares, l%polish)//' ' &
         //whole(count(part >= 0.0_wp)))
   end subroutine write_quantity
end module contributions_table
